//! The faces of the admissible set: constants of a rover, made once.
//!
//! The admissible twists are a union of cones. The point of it nearest to a wanted twist lies inside one of its faces,
//! and is there the orthogonal projection onto the subspace in which the planes that meet in that face intersect. That
//! projection is linear in the wanted twist, also where some of its components are to be kept: so every face is a
//! matrix, and a projection is a few products and a comparison.
//!
//! Distances are by the rover's metric, the mean square change of the pivots' velocities [m²/s²].

use nalgebra::{Cholesky, Matrix3, Vector3};

use super::Keep;
use crate::admissible::cone::AdmissibleCone;
use crate::rover_data::RoverData;
use six_wheel_numerics::jacobi::Jacobi;

/// Share of a twist's size below which a component of its projection is rounding.
pub(crate) const VANISHED: f64 = 1e-14;

/// Squared sine of the angle below which two conditions are one.
const INDEPENDENT: f64 = 1e-12;

/// Largest difference of the matrices of two faces that are one [share of a twist].
const SAME: f64 = 1e-13;

/// Share of a matrix below which what is left of it is rounding.
const ROUNDING: f64 = 1e-12;

/// Share of a wanted twist by which kept components may miss a face that does not leave them free.
pub(crate) const AGREED: f64 = 1e-9;

/// A face, under the components of the twist that are kept.
#[derive(Clone, Debug)]
pub struct Face {
    /// The nearest point is the sum of the directions, each times the product of its row with the wanted twist. The
    /// directions span the subspace, so that the point is in it to rounding of its own size.
    pub span: Vec<[[f64; 3]; 2]>,
    /// The distance squared is the sum of the squares of the products of these rows with the wanted twist.
    pub miss: Vec<[f64; 3]>,
    /// Joints whose ranges the point need not be in. None left: all of it is admissible.
    pub open: Vec<usize>,
    /// True if the planes themselves restrict the kept components, so that the two may contradict each other.
    pub bound: bool,
}

impl Face {
    fn is(&self, other: &Self) -> bool {
        self.bound == other.bound
            && self.span.len() == other.span.len()
            && (self.matrix() - other.matrix()).amax() <= SAME
    }

    fn matrix(&self) -> Matrix3<f64> {
        let product = |[direction, row]: &[[f64; 3]; 2]| Vector3::from(*direction) * Vector3::from(*row).transpose();
        self.span.iter().map(product).sum()
    }
}

/// The faces that a projection has to look at, for each way of keeping something.
#[derive(Clone, Debug)]
pub struct Faces {
    kept: [Vec<Face>; 4],
    /// Lᵀ of the metric L Lᵀ: the largest component of its product with a twist is the size that rounding is a share of.
    pub size: [[f64; 3]; 3],
}

/// Components that are kept: indices into the twist.
pub(crate) fn components(keep: Keep) -> &'static [usize] {
    match keep {
        Keep::Curvature => &[0, 2],
        Keep::Speed => &[0],
        Keep::YawRate => &[2],
        Keep::Nearest => &[],
    }
}

impl Faces {
    pub fn new(rover: &RoverData, cone: &AdmissibleCone) -> Self {
        let size = Cholesky::new(rover.metric).map_or_else(Matrix3::identity, |factor| factor.l().transpose());
        let all = [Keep::Curvature, Keep::Speed, Keep::YawRate, Keep::Nearest];
        Self {
            kept: all.map(|keep| faces(rover, cone, &size, keep)),
            size: [0, 1, 2].map(|i| size.row(i).transpose().into()),
        }
    }

    /// In the order in which the first of equally near ones counts.
    #[inline]
    pub fn of(&self, keep: Keep) -> &[Face] {
        &self.kept[keep as usize]
    }
}

/// All faces: no plane, one or two planes on which a wheel rolls at an end of its range, among those of the fixed wheels.
fn faces(rover: &RoverData, cone: &AdmissibleCone, size: &Matrix3<f64>, keep: Keep) -> Vec<Face> {
    let banks: Vec<_> = rover.banks.iter().map(|bank| bank.row).collect();
    let limits = rover.limit_rows();
    let Some(to_twist) = size.try_inverse() else {
        return Vec::new();
    };
    let maker = Maker { rover, cone, size, to_twist, kept: components(keep) };
    let mut found: Vec<Face> = Vec::new();
    let mut planes = banks;
    let mut add = |planes: &[Vector3<f64>]| {
        let Some((face, is_point)) = maker.face(planes) else {
            return true;
        };
        if maker.may_count(&face) && !found.iter().any(|other| other.is(&face)) {
            found.push(face);
        }
        is_point
    };
    // The kept components and the planes leave one point: the same point, or none, on every face of that one.
    if add(&planes) {
        return found;
    }
    for (k, &first) in limits.iter().enumerate() {
        planes.push(first);
        if !add(&planes) {
            for &second in &limits[k + 1..] {
                planes.push(second);
                add(&planes);
                planes.pop();
            }
        }
        planes.pop();
    }
    found
}

struct Maker<'a> {
    rover: &'a RoverData,
    cone: &'a AdmissibleCone,
    size: &'a Matrix3<f64>,
    to_twist: Matrix3<f64>,
    kept: &'static [usize],
}

impl Maker<'_> {
    /// A condition for unknowns in which distance is plain length, of length one.
    fn scaled(&self, row: &Vector3<f64>) -> Vector3<f64> {
        (self.to_twist.transpose() * row).normalize()
    }

    /// The face in which planes meet, and whether it is but a point under what is kept. Nothing where only zero is left.
    fn face(&self, planes: &[Vector3<f64>]) -> Option<(Face, bool)> {
        let rows: Vec<_> = planes.iter().map(|row| self.scaled(row)).collect();
        let normal: Matrix3<f64> = rows.iter().map(|row| row * row.transpose()).sum();
        let directions = self.basis(&rows, Jacobi::new(&normal).rank(INDEPENDENT));
        if directions.is_empty() {
            return None;
        }
        // With the directions N and the kept components K, the nearest point N c to y has K N c = K y, and c is as near
        // to Nᵀ y as that lets it be: c = B⁺ K y + (1 - B⁺ B) Nᵀ y, where B = K N.
        let mut kept = Matrix3::zeros();
        let mut basis = Matrix3::zeros();
        for (k, &component) in self.kept.iter().enumerate() {
            kept.set_row(k, &self.scaled(&unit(component)).transpose());
        }
        for (k, direction) in directions.iter().enumerate() {
            basis.set_column(k, direction);
        }
        let seen = Jacobi::new(&(kept * basis));
        let bound = INDEPENDENT.sqrt();
        let (inverse, rank) = (seen.inverse(bound), seen.rank(bound));
        let free = if rank == directions.len() {
            Matrix3::zeros() // and not what rounding makes of it: kept zeros stay zero
        } else {
            (Matrix3::identity() - inverse * kept * basis) * basis.transpose()
        };
        let mut to_kept = Matrix3::zeros();
        for (k, &component) in self.kept.iter().enumerate() {
            let length = (self.to_twist.transpose() * unit(component)).norm();
            to_kept[(k, component)] = 1.0 / length;
        }
        let rows = inverse * to_kept + free * self.size;
        let part = |(k, direction): (usize, &Vector3<f64>)| {
            let twist = self.without_rounding(self.to_twist * direction);
            [twist.into(), rows.row(k).transpose().into()]
        };
        let missed = Jacobi::new(&(Matrix3::identity() - basis * (inverse * kept + free)));
        let miss = (0..missed.rank(ROUNDING))
            .map(|k| (self.size.transpose() * missed.turn.column(k) * missed.values[k]).into())
            .collect();
        let face = Face {
            span: directions.iter().enumerate().map(part).collect(),
            miss,
            open: Vec::new(),
            bound: rank < self.kept.len(),
        };
        Some((self.opened(face), rank == directions.len()))
    }

    /// Orthonormal directions in which no scaled condition changes.
    fn basis(&self, rows: &[Vector3<f64>], rank: usize) -> Vec<Vector3<f64>> {
        match rank {
            0 => (0..3).map(unit).collect(),
            1 => {
                let row = rows[0];
                let twist = self.to_twist.transpose().try_inverse().map_or(row, |back| back * row);
                // Twists that are zero but for two components: what does not couple stays apart.
                let pivot = twist.iamax();
                let mut basis: Vec<Vector3<f64>> = Vec::new();
                for k in (0..3).filter(|k| *k != pivot) {
                    let mut direction = unit(k);
                    direction[pivot] = -twist[k] / twist[pivot];
                    let mut direction = self.size * direction;
                    for other in &basis {
                        direction -= other * other.dot(&direction);
                    }
                    basis.push(direction.normalize());
                }
                basis
            }
            2 => {
                let crossed = rows.iter().enumerate().flat_map(|(k, a)| rows[k + 1..].iter().map(move |b| a.cross(b)));
                let longest = crossed.max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
                longest.map(|row| row.normalize()).into_iter().collect()
            }
            _ => Vec::new(),
        }
    }

    /// A component that vanishes beside the others is zero.
    fn without_rounding(&self, twist: Vector3<f64>) -> Vector3<f64> {
        let lengths = Vector3::new(1.0, 1.0, self.rover.size);
        let largest = twist.component_mul(&lengths).amax();
        twist.zip_map(&lengths, |part, length| if part.abs() * length <= VANISHED * largest { 0.0 } else { part })
    }

    /// True if a plane contains all of a face, to rounding.
    fn holds(&self, row: &Vector3<f64>, face: &Face) -> bool {
        let scaled = self.scaled(row);
        face.span.iter().all(|[direction, _]| {
            let along = scaled.dot(&(self.size * Vector3::from(*direction)));
            along.abs() <= 1e3 * f64::EPSILON
        })
    }

    /// With the joints that have to be looked at: those of a limited range that is not at an end all over the face.
    fn opened(&self, mut face: Face) -> Face {
        if face.span.len() < 2 {
            return face;
        }
        let planes = self.rover.limit_planes();
        let open = planes.iter().filter(|(_, rows)| !rows.iter().any(|row| self.holds(row, &face)));
        face.open = open.map(|(joint, _)| *joint).collect();
        face
    }

    /// True if the nearest point of a face can be admissible without being there already.
    fn may_count(&self, face: &Face) -> bool {
        match face.span.as_slice() {
            [[direction, _]] => self.cone.is_possible(Vector3::from(*direction).into()),
            // The whole space is the wanted twist itself, which has been tried; and unsteered wheels that are not quite
            // parallel have no plane in common.
            parts => {
                let mut banks = self.rover.banks.iter();
                parts.len() < 3 && banks.all(|bank| self.holds(&bank.row, face))
            }
        }
    }
}

fn unit(k: usize) -> Vector3<f64> {
    Matrix3::identity().column(k).into_owned()
}
