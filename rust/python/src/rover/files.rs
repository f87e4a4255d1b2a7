//! `Rover.urdf` and `Rover.save`.

use pyo3::prelude::*;

use super::Rover;

methods! { Rover:
    /// The text of a URDF from which `load` makes this rover again, and which viewers open.
    #[doc = section!(Parameters)]
    /// name : str
    ///     Of the robot.
    #[doc = returns!("str")]
    ///     With a link and a joint for every wheel and its steering, under the names of the joints, and
    ///     rockers and bogies where there is a suspension. The base frame lies on the ground, a suspension's
    ///     where it has its own.
    #[doc = raises!("If a wheel is none that a URDF can hold: with rollers.")]
    fn urdf[slf: &Bound<'py, Self>](name: &str = "rover") -> PyResult<String> {
        let module = slf.py().import("six_wheel.robot_description.urdf")?;
        module.call_method1("rover_urdf", (slf, name))?.extract()
    }

    /// Writes a file from which `load` makes an equal rover: a parameter file, or a robot description.
    #[doc = section!(Parameters)]
    /// path : path
    ///     Ends in .yaml, .yml or .urdf. A file that is there is replaced.
    /// **others
    ///     Of a parameter file: `node`, `limits`, `control`, `odom_frame_id`, `base_frame_id`.
    #[doc = raises!("If no such file can say what this rover is, or the ending is none of these.")]
    fn save[slf: &Bound<'py, Self>](path, **others) -> PyResult<()> {
        let module = slf.py().import("six_wheel.robot_description.saving")?;
        module.getattr("save_rover")?.call((slf, path), others).map(drop)
    }
}
