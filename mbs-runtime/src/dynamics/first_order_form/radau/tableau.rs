//! The numbers of Radau IIA with three stages.
//!
//! Source: Hairer & Wanner 1996, table IV.5.6 and §IV.8, with T as in their program RADAU5.

/// Places of the stages in the step.
pub(super) const C: [f64; 3] = [0.1550510257216822, 0.6449489742783178, 1.0];

/// The real eigenvalue of A⁻¹.
pub(super) const REAL: f64 = 3.637834252744496;

/// Real and imaginary part of the complex eigenvalue of A⁻¹ that is used; the other one is its conjugate.
pub(super) const COMPLEX: [f64; 2] = [2.6810828736277523, -3.0504301992474105];

/// T: stages from transformed ones.
pub(super) const T: [[f64; 3]; 3] = [
    [0.09443876248897524, -0.1412552950209542, 0.03002919410514742],
    [0.2502131229653333, 0.20412935229379994, -0.3829421127572619],
    [1.0, 1.0, 0.0],
];

/// T⁻¹: transformed stages from stages. T⁻¹ A⁻¹ T has the real eigenvalue first, then the complex one as real and imaginary part.
pub(super) const T_INVERSE: [[f64; 3]; 3] = [
    [4.178718591551904, 0.32768282076106237, 0.5233764454994495],
    [-4.178718591551904, -0.32768282076106237, 0.47662355450055044],
    [0.5028726349457868, -2.571926949855605, 0.5960392048282249],
];

/// The error estimate: weights of the changes to the stages over the step, in addition to the rate at its start.
pub(super) const ERROR: [f64; 3] = [-10.048809399827416, 1.382142733160749, -0.3333333333333333];

/// Weights of the changes to the stages in the terms θ, θ², θ³ of the dense output.
pub(super) const DENSE: [[f64; 3]; 3] = [
    [10.048809399827416, -1.382142733160749, 0.3333333333333333],
    [-25.62959144707664, 10.296258113743306, -2.6666666666666665],
    [15.580782047249224, -8.914115380582556, 3.3333333333333335],
];
