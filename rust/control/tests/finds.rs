//! Inputs that fuzzing of the core found (`rust/fuzz/finds`, by the target's name), run again.

#[path = "../../fuzz/doors/lib.rs"]
mod doors;

use doors::{controller, estimate, odometry};

#[test]
fn what_fuzzing_found() -> std::io::Result<()> {
    let finds = concat!(env!("CARGO_MANIFEST_DIR"), "/../fuzz/finds");
    let mut count = 0;
    for find in std::fs::read_dir(finds)? {
        let path = find?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        println!("{name}");
        let content = std::fs::read(&path)?;
        match name.split('-').next().unwrap_or_default() {
            "controller" => controller::one(&content),
            "estimate" => estimate::one(&content),
            "odometry" => odometry::one(&content),
            other => assert_eq!(other, "a target"),
        }
        count += 1;
    }
    assert!(count >= 20, "{count}");
    Ok(())
}
