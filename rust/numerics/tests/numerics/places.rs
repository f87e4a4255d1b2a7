//! Arrays that have an element in common, and items over each other.

use six_wheel_numerics::places::Places;

fn places(start: usize, axes: &[(usize, isize)], item: usize) -> Places {
    Places::new(start, axes.iter().copied(), item)
}

/// Every byte of an array.
fn bytes(start: usize, axes: &[(usize, isize)], item: usize) -> Vec<usize> {
    let mut all: Vec<usize> = (start..start + item).collect();
    for (length, stride) in axes {
        let along = |k: usize| stride * k.cast_signed();
        all = all.iter().flat_map(|byte| (0..*length).map(move |k| byte.wrapping_add_signed(along(k)))).collect();
    }
    all
}

#[test]
fn columns_of_one_table_are_apart_and_neighbours_are_not() {
    let column = |first: usize, count| places(1000 + 8 * first, &[(100_000, 160), (count, 8)], 8);
    assert!(!column(0, 4).share(&column(4, 4)));
    assert!(column(0, 5).share(&column(4, 4)));
    let every_second = |first: usize| places(1000 + 8 * first, &[(5000, 160), (4, 16)], 8);
    assert!(!every_second(0).share(&every_second(1)));
    assert!(!every_second(0).share(&every_second(8)));
    assert!(every_second(0).share(&every_second(6)));
}

#[test]
fn items_over_each_other() {
    assert!(places(0, &[(5, 24), (3, 8)], 8).are_apart());
    assert!(places(0, &[(5, 8), (3, 40)], 8).are_apart());
    assert!(places(0, &[(5, -48), (3, 16), (1, 0)], 8).are_apart());
    assert!(!places(0, &[(5, 8), (3, 8)], 8).are_apart());
    assert!(!places(0, &[(5, 0)], 8).are_apart());
    assert!(!places(0, &[(5, 4)], 8).are_apart());
}

#[test]
fn the_same_as_byte_by_byte() {
    let mut seed = 1_u64;
    let mut random = |below: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) % below
    };
    for _ in 0..20_000 {
        let mut any = || {
            let axes: Vec<(usize, isize)> =
                (0..random(4)).map(|_| (random(4) as usize, random(41) as isize - 20)).collect();
            (1000 + random(60) as usize, axes, 1 + random(8) as usize)
        };
        let ((a, first, size), (b, second, other)) = (any(), any());
        let ours = bytes(a, &first, size);
        let theirs = bytes(b, &second, other);
        let expected = ours.iter().any(|byte| theirs.contains(byte));
        let found = places(a, &first, size).share(&places(b, &second, other));
        assert_eq!(found, expected, "{a} {first:?} {size}, {b} {second:?} {other}");
    }
}
