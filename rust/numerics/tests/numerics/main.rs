//! Tests of numbers in registers, small matrices and threads.

mod jacobi;
mod lanes;
mod places;
mod polynomials;
mod sizes;
mod threads;
