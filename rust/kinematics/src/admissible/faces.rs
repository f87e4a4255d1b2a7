//! The faces of the admissible set: constants of a rover, made once.
//!
//! The admissible twists are a union of cones. Their point nearest to a desired twist lies inside one of the faces, and
//! is the orthogonal projection onto the intersection of the planes that meet in that face. The projection is linear in
//! the desired twist, also where some of its components are kept: every face is a matrix, and a projection is a few
//! products and a comparison.
//!
//! Distances are by the rover's metric, the mean square change of the pivots' velocities [m²/s²].

use nalgebra::{Cholesky, Matrix3, Vector3};

use super::Keep;
use crate::admissible::cone::AdmissibleCone;
use crate::rover_data::RoverData;
use six_wheel_numerics::jacobi::Jacobi;

/// A component of a projection below this share of the twist's size is rounding, and set to 0.
pub(crate) const VANISHED: f64 = 1e-14;

/// Two planes are the same if the squared sine of the angle between them is below this.
const INDEPENDENT: f64 = 1e-12;

/// Two faces are the same if no entries of their matrices differ by more than this [share of a twist].
const SAME: f64 = 1e-13;

/// A singular value of a residual matrix below this is rounding.
const ROUNDING: f64 = 1e-12;

/// Error of the kept components, as a share of the desired twist, up to which a point of a face that restricts them
/// counts.
pub(crate) const AGREED: f64 = 1e-9;

/// A face, under the components of the twist that are kept.
#[derive(Clone, Debug)]
pub struct Face {
    /// Pairs of a direction and a row: the nearest point is `sum direction (row . desired twist)`. The directions span
    /// the subspace, so that the error of the point's distance from it is rounding of the point's own size.
    pub span: Vec<[[f64; 3]; 2]>,
    /// The squared distance is `sum (row . desired twist)^2` over these rows [m²/s²].
    pub distance_rows: Vec<[f64; 3]>,
    /// Joints whose ranges the nearest point may be outside of. Empty: every point of the face is admissible.
    pub unchecked_joints: Vec<usize>,
    /// True if the planes restrict the kept components, so that the face may have no point with the desired ones.
    pub restricts_kept: bool,
}

impl Face {
    fn equals(&self, other: &Self) -> bool {
        self.restricts_kept == other.restricts_kept
            && self.span.len() == other.span.len()
            && (self.matrix() - other.matrix()).amax() <= SAME
    }

    fn matrix(&self) -> Matrix3<f64> {
        let product = |[direction, row]: &[[f64; 3]; 2]| Vector3::from(*direction) * Vector3::from(*row).transpose();
        self.span.iter().map(product).sum()
    }
}

/// The faces among which a projection finds the nearest point, for each value of [`Keep`].
#[derive(Clone, Debug)]
pub struct Faces {
    kept: [Vec<Face>; 4],
    /// `Lᵀ` of the metric `L Lᵀ`: the largest component of its product with a twist is the size of the twist [m/s].
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
        Self {
            kept: Keep::ALL.map(|keep| faces(rover, cone, &size, keep)),
            size: [0, 1, 2].map(|i| size.row(i).transpose().into()),
        }
    }

    /// The faces for a value of [`Keep`]; of equally near ones the first counts.
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
    let builder = FaceBuilder { rover, cone, size, to_twist, kept: components(keep) };
    let mut found: Vec<Face> = Vec::new();
    let mut planes = banks;
    let mut add = |planes: &[Vector3<f64>]| {
        let Some((face, is_point)) = builder.face(planes) else {
            return true;
        };
        if builder.is_candidate(&face) && !found.iter().any(|other| other.equals(&face)) {
            found.push(face);
        }
        is_point
    };
    // Where planes and kept components determine one point, every face of that face has the same point or none.
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

/// Input of the construction of faces. Unknowns are scaled: `Lᵀ twist`, in which the rover's metric is plain length.
struct FaceBuilder<'a> {
    rover: &'a RoverData,
    cone: &'a AdmissibleCone,
    /// `Lᵀ`, from a twist to the scaled unknowns.
    size: &'a Matrix3<f64>,
    /// The inverse of `size`.
    to_twist: Matrix3<f64>,
    /// Indices of the components of the twist that are kept.
    kept: &'static [usize],
}

impl FaceBuilder<'_> {
    /// The normal of a plane for the scaled unknowns, of length one.
    fn scaled(&self, row: &Vector3<f64>) -> Vector3<f64> {
        (self.to_twist.transpose() * row).normalize()
    }

    /// The face in which planes meet, and true if it has one point with the kept components. None if the planes meet in
    /// the zero twist alone.
    fn face(&self, planes: &[Vector3<f64>]) -> Option<(Face, bool)> {
        let rows: Vec<_> = planes.iter().map(|row| self.scaled(row)).collect();
        let normal: Matrix3<f64> = rows.iter().map(|row| row * row.transpose()).sum();
        let directions = self.basis(&rows, Jacobi::new(&normal).rank(INDEPENDENT));
        if directions.is_empty() {
            return None;
        }
        // With the directions N and the kept components K, the point N c nearest to y has K N c = K y, and c is the one
        // of these nearest to Nᵀ y: c = B⁺ K y + (1 - B⁺ B) Nᵀ y, where B = K N.
        let mut kept = Matrix3::zeros();
        let mut basis = Matrix3::zeros();
        for (k, &component) in self.kept.iter().enumerate() {
            kept.set_row(k, &self.scaled(&unit(component)).transpose());
        }
        for (k, direction) in directions.iter().enumerate() {
            basis.set_column(k, direction);
        }
        let kept_of_basis = Jacobi::new(&(kept * basis));
        let bound = INDEPENDENT.sqrt();
        let (inverse, rank) = (kept_of_basis.inverse(bound), kept_of_basis.rank(bound));
        let free = if rank == directions.len() {
            Matrix3::zeros() // without rounding errors: kept zeros stay zero
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
        let residual = Jacobi::new(&(Matrix3::identity() - basis * (inverse * kept + free)));
        let distance_rows = (0..residual.rank(ROUNDING))
            .map(|k| (self.size.transpose() * residual.turn.column(k) * residual.values[k]).into())
            .collect();
        let face = Face {
            span: directions.iter().enumerate().map(part).collect(),
            distance_rows,
            unchecked_joints: Vec::new(),
            restricts_kept: rank < self.kept.len(),
        };
        Some((self.with_unchecked_joints(face), rank == directions.len()))
    }

    /// Orthonormal directions, of scaled unknowns, that lie in all planes with these normals of this rank.
    fn basis(&self, rows: &[Vector3<f64>], rank: usize) -> Vec<Vector3<f64>> {
        match rank {
            0 => (0..3).map(unit).collect(),
            1 => {
                let row = rows[0];
                let twist = self.to_twist.transpose().try_inverse().map_or(row, |back| back * row);
                // Twists of which two components are not 0, so that components without a common condition are not
                // mixed.
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

    /// The twist with 0 in place of components that are rounding beside the largest one.
    fn without_rounding(&self, twist: Vector3<f64>) -> Vector3<f64> {
        let lengths = Vector3::new(1.0, 1.0, self.rover.size);
        let largest = twist.component_mul(&lengths).amax();
        twist.zip_map(&lengths, |part, length| if part.abs() * length <= VANISHED * largest { 0.0 } else { part })
    }

    /// True if a plane contains all of a face, to rounding.
    fn contains(&self, row: &Vector3<f64>, face: &Face) -> bool {
        let scaled = self.scaled(row);
        face.span.iter().all(|[direction, _]| {
            let along = scaled.dot(&(self.size * Vector3::from(*direction)));
            along.abs() <= 1e3 * f64::EPSILON
        })
    }

    /// The face with its unchecked joints: those of a limited range that are not at an end of it on the whole face.
    fn with_unchecked_joints(&self, mut face: Face) -> Face {
        if face.span.len() < 2 {
            return face;
        }
        let planes = self.rover.limit_planes();
        let unchecked = planes.iter().filter(|(_, rows)| !rows.iter().any(|row| self.contains(row, &face)));
        face.unchecked_joints = unchecked.map(|(joint, _)| *joint).collect();
        face
    }

    /// True if the nearest point of a face may be admissible and another one than the desired twist.
    fn is_candidate(&self, face: &Face) -> bool {
        match face.span.as_slice() {
            [[direction, _]] => self.cone.is_possible(Vector3::from(*direction).into()),
            // The point of the whole space is the desired twist itself, which is not admissible; and the planes of
            // unsteered wheels that are not quite parallel do not coincide.
            parts => {
                let mut banks = self.rover.banks.iter();
                parts.len() < 3 && banks.all(|bank| self.contains(&bank.row, face))
            }
        }
    }
}

fn unit(k: usize) -> Vector3<f64> {
    Matrix3::identity().column(k).into_owned()
}
