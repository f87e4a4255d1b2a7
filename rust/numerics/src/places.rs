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
