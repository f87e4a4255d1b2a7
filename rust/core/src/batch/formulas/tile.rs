//! Eight steps in every lane, from twists to poses: what logs side by side and a log cut into pieces share.
//!
//! Inside a tile every lane sums its steps plainly, from zero; from tile to tile in compensated sums, with the
//! heading kept within half a turn. Rounding therefore grows with the length of a few steps, not with that of
//! the log.

use crate::batch::machine::lanes::{Lanes, Lockstep, Mask};
use crate::batch::machine::polynomials::{direction, sinc_of_square};
use crate::batch::machine::vector::Vector;
use crate::geometry::{Steps, Sum};

/// Steps of a tile in one lane.
pub(crate) const STEPS: usize = 8;

/// Numbers of these steps, twists or poses.
pub(crate) const WIDTH: usize = 3 * STEPS;

/// Lanes at most.
pub(crate) const LANES: usize = 8;

/// Half of a step's turn up to which the chord is a polynomial [rad].
const LARGEST_HALF_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// Half a turn and what rounding adds: a heading beyond it has turned so far in one step that it has no digits.
pub(crate) const LARGEST_HEADING: f64 = 4.0;

/// One register per step.
pub(crate) type PerStep<S> = [Lanes<S>; STEPS];

/// One row of numbers per lane into one register per number.
#[inline(always)]
pub(crate) fn columns<S: Vector, const N: usize>(
    simd: S,
    rows: &[&[f64; N]; LANES],
    columns: &mut [S::f64s; N],
) {
    for (c, columns) in columns.as_chunks_mut::<8>().0.iter_mut().enumerate() {
        let mut group = *columns;
        for (j, register) in group.iter_mut().enumerate() {
            let square = (8 * c + j) / S::F64_LANES;
            *register = S::as_simd_f64s(rows[j % S::F64_LANES]).0[square];
        }
        *columns = simd.transpose(group);
    }
}

/// The reverse.
#[inline(always)]
fn rows<S: Vector>(simd: S, columns: &[S::f64s; WIDTH], rows: &mut [&mut [f64; WIDTH]; LANES]) {
    for (c, columns) in columns.as_chunks::<8>().0.iter().enumerate() {
        let group = simd.transpose(*columns);
        for (j, register) in group.into_iter().enumerate() {
            let square = (8 * c + j) / S::F64_LANES;
            S::as_mut_simd_f64s(rows[j % S::F64_LANES]).0[square] = register;
        }
    }
}

/// Where every lane has come to: compensated sums.
#[derive(Clone, Copy)]
pub(crate) struct Sums<S: Vector> {
    pub sum: Lanes<S>,
    pub lost: Lanes<S>,
}

impl<S: Vector> Sums<S> {
    /// The same in every lane.
    #[inline(always)]
    pub fn splat(simd: S, sum: &Sum) -> Self {
        Self {
            sum: Lanes::splat(simd, sum.sum),
            lost: Lanes::splat(simd, sum.lost),
        }
    }

    /// So much more than the sum.
    #[inline(always)]
    pub fn beyond(&self, more: Lanes<S>) -> Lanes<S> {
        self.sum + (self.lost + more)
    }

    /// [`Sum::add`] in every lane.
    #[inline(always)]
    pub fn add(&mut self, term: Lanes<S>) {
        let total = self.sum + term;
        let added = total - self.sum;
        self.lost = self.lost + ((self.sum - (total - added)) + (term - added));
        self.sum = total;
    }
}

/// What is known of the steps on the way to their poses; turns and chords count from the tile's beginning.
///
/// Three short loops instead of a long one: the processor then works on many steps at once.
#[repr(C, align(64))]
pub(crate) struct Tile<S: Vector> {
    /// Twists, and then poses, number by number.
    pub numbers: [S::f64s; WIDTH],
    /// Way ahead and to the left at constant heading [m], and then place after the step, in world axes.
    way: [[S::f64s; STEPS]; 2],
    /// Half of the step's turn [rad].
    half: [S::f64s; STEPS],
    /// Heading along the step's chord [rad].
    along: [S::f64s; STEPS],
    /// Turn after the step [rad].
    turned: [S::f64s; STEPS],
}

impl<S: Vector> Tile<S> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let zero = simd.splat_f64s(0.0);
        Self {
            numbers: [zero; WIDTH],
            way: [[zero; STEPS]; 2],
            half: [zero; STEPS],
            along: [zero; STEPS],
            turned: [zero; STEPS],
        }
    }

    /// Reads twists.
    #[inline(always)]
    pub fn read(&mut self, simd: S, twists: &[&[f64; WIDTH]; LANES]) {
        columns(simd, twists, &mut self.numbers);
    }

    /// Turn of all steps together [rad]; where the polynomials reach. The yaws are placed if it is known
    /// where they begin.
    #[inline(always)]
    pub fn turn(
        &mut self,
        simd: S,
        dts: &PerStep<S>,
        yaw: Option<&Sums<S>>,
    ) -> (Lanes<S>, Mask<S>) {
        let largest = Lanes::splat(simd, LARGEST_HALF_TURN);
        let mut near = largest.at_most(largest);
        let mut turned = Lanes::splat(simd, 0.0);
        for (t, dt) in dts.iter().enumerate() {
            for (j, way) in self.way.iter_mut().enumerate() {
                (Lanes::load(simd, &self.numbers, 3 * t + j) * *dt).store(way, t);
            }
            let turn = Lanes::load(simd, &self.numbers, 3 * t + 2) * *dt;
            let half = turn * Lanes::splat(simd, 0.5);
            near = near & half.abs().at_most(largest);
            half.store(&mut self.half, t);
            (turned + half).store(&mut self.along, t);
            turned = turned + turn;
            match yaw {
                Some(yaw) => yaw.beyond(turned).store(&mut self.numbers, 3 * t + 2),
                None => turned.store(&mut self.turned, t),
            }
        }
        (turned, near)
    }

    /// Chords of the steps in world axes, added up. The way over the whole tile. The places are set if it is
    /// known where they begin.
    #[inline(always)]
    pub fn walk(
        &mut self,
        simd: S,
        heading: &Sums<S>,
        place: Option<[&Sums<S>; 2]>,
    ) -> [Lanes<S>; 2] {
        let zero = Lanes::splat(simd, 0.0);
        let [mut x, mut y] = [zero; 2];
        let [east, north] = &mut self.way;
        let [mut headings, mut squares] = [Lockstep([zero; STEPS]); 2];
        for t in 0..STEPS {
            let half = Lanes::load(simd, &self.half, t);
            squares.0[t] = half * half;
            headings.0[t] = heading.beyond(Lanes::load(simd, &self.along, t));
        }
        // Along the chord, which leaves at half the turn.
        let (sin, cos) = direction(simd, headings);
        let length = sinc_of_square(simd, squares);
        for t in 0..STEPS {
            let (sin, cos) = (sin.0[t], cos.0[t]);
            let ahead = Lanes::load(simd, east, t) * length.0[t];
            let left = Lanes::load(simd, north, t) * length.0[t];
            x = x + (cos * ahead - sin * left);
            y = y + sin.mul_add(ahead, cos * left);
            match place {
                Some([east, north]) => {
                    east.beyond(x).store(&mut self.numbers, 3 * t);
                    north.beyond(y).store(&mut self.numbers, 3 * t + 1);
                }
                None => {
                    x.store(east, t);
                    y.store(north, t);
                }
            }
        }
        [x, y]
    }

    /// Sets places and yaws, where it was not known before where they begin.
    #[inline(always)]
    pub fn place(&mut self, simd: S, [x, y, yaw]: [&Sums<S>; 3]) {
        let [east, north] = &self.way;
        for t in 0..STEPS {
            let place = [(x, east), (y, north), (yaw, &self.turned)];
            for (j, (sum, more)) in place.into_iter().enumerate() {
                let number = sum.beyond(Lanes::load(simd, more, t));
                number.store(&mut self.numbers, 3 * t + j);
            }
        }
    }

    /// Writes poses.
    #[inline(always)]
    pub fn write(&self, simd: S, poses: &mut [&mut [f64; WIDTH]; LANES]) {
        rows(simd, &self.numbers, poses);
    }
}

/// Durations of steps that are the same in every lane; past the end of the log any will do.
#[inline(always)]
pub(crate) fn durations<S: Vector>(simd: S, steps: Steps<'_>, first: usize) -> PerStep<S> {
    let mut dts = [Lanes::splat(simd, 0.0); STEPS];
    for (t, dt) in dts.iter_mut().enumerate() {
        match steps {
            Steps::Constant(constant) => *dt = Lanes::splat(simd, constant),
            Steps::Each(dts) => {
                *dt = Lanes::splat(simd, dts.get(first + t).copied().unwrap_or(1.0));
            }
        }
    }
    dts
}
