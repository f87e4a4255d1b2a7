//! Addresses of the elements of an array, and the test if two arrays have one in common.

/// Steps of the search for a byte that two arrays share. Views of one table take a few; arrays whose search takes more
/// count as overlapping.
const STEPS: usize = 10_000;

/// Steps of a number of bytes each, and their largest number.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Term {
    bytes: usize,
    most: usize,
}

/// The bytes of an array: from the lowest one on, any number of steps of every term.
#[derive(Clone, Debug)]
pub struct Places {
    lowest: usize,
    terms: Vec<Term>,
    is_empty: bool,
    /// True if an axis of several elements has stride 0.
    repeats: bool,
}

impl Places {
    /// Those of an array whose first element begins at address `data`, by length and stride [bytes] of its axes and the
    /// size of an item.
    pub fn new(data: usize, axes: impl Iterator<Item = (usize, isize)>, item: usize) -> Self {
        let mut places = Self {
            lowest: data,
            terms: vec![Term { bytes: 1, most: item.saturating_sub(1) }],
            is_empty: item == 0,
            repeats: false,
        };
        for (length, stride) in axes {
            let Some(most) = length.checked_sub(1) else {
                places.is_empty = true;
                continue;
            };
            let bytes = stride.unsigned_abs();
            if stride < 0 {
                places.lowest = places.lowest.wrapping_sub(most.wrapping_mul(bytes));
            }
            places.repeats |= bytes == 0 && most > 0;
            if bytes > 0 && most > 0 {
                places.terms.push(Term { bytes, most });
            }
        }
        places
    }

    /// Bytes from the lowest to the highest.
    fn reach(&self) -> usize {
        let reach = |term: &Term| term.bytes.saturating_mul(term.most);
        self.terms.iter().map(reach).fold(0, usize::saturating_add)
    }

    /// True if there is a byte in both.
    pub fn share(&self, other: &Self) -> bool {
        if self.is_empty || other.is_empty {
            return false;
        }
        // A byte in both: lowest + sum of steps of this array = highest of the other one - sum of steps of that.
        let highest = other.lowest.saturating_add(other.reach());
        let Some(distance) = highest.checked_sub(self.lowest) else {
            return false;
        };
        let mut terms: Vec<Term> = self.terms.iter().chain(&other.terms).copied().collect();
        terms.sort_unstable_by_key(|term| std::cmp::Reverse(term.bytes));
        terms.dedup_by(|next, term| {
            let alike = next.bytes == term.bytes;
            if alike {
                term.most = term.most.saturating_add(next.most);
            }
            alike
        });
        is_sum_of_steps(distance, &terms, &mut 0)
    }

    /// True if no two items overlap; false also where that takes more than a comparison of strides to find out.
    pub fn are_apart(&self) -> bool {
        let mut taken = 1_usize;
        let mut terms: Vec<&Term> = self.terms.iter().collect();
        terms.sort_unstable_by_key(|term| term.bytes);
        !self.repeats
            && terms.iter().all(|term| {
                let fits = term.most == 0 || term.bytes >= taken;
                taken = taken.saturating_add(term.bytes.saturating_mul(term.most));
                fits
            })
    }
}

/// True if `distance` [bytes] is a sum of steps of these terms, the longest first. True also if the search takes more
/// than [`STEPS`].
fn is_sum_of_steps(distance: usize, terms: &[Term], steps: &mut usize) -> bool {
    *steps += 1;
    let Some((longest, rest)) = terms.split_first() else {
        return distance == 0;
    };
    if *steps > STEPS {
        return true;
    }
    let reach = |term: &Term| term.bytes.saturating_mul(term.most);
    let rest_at_most = rest.iter().map(reach).fold(0, usize::saturating_add);
    let most = longest.most.min(distance / longest.bytes);
    let least = distance.saturating_sub(rest_at_most).div_ceil(longest.bytes);
    (least..=most).any(|count| *steps > STEPS || is_sum_of_steps(distance - count * longest.bytes, rest, steps))
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
