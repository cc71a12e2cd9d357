/// Four-bar linkage with a coupler point.
///
/// # Structure
/// 5 coordinates: `x2` (m), `y2` (m), `phi1` (rad), `phi2` (rad), `phi3` (rad).
/// 5 rows: `coupler_point.0` (m), `coupler_point.1` (m), `closure.0` (m), `closure.1` (m), `crank` (rad).
/// 1 output: `transmission_angle` (rad).
/// Reference length: `L4` (0.3 m).
///
/// `Φ_q` has 13 of 25 entries (1: a number, p: parameters alone, x: varies):
/// ```text
///                  x2 y2 phi1 phi2 phi3
/// coupler_point.0  1  .   x    x    .
/// coupler_point.1  .  1   x    x    .
/// closure.0        .  .   x    x    x
/// closure.1        .  .   x    x    x
/// crank            .  .   1    .    .
/// ```
///
/// Solved block after block:
/// 1. `phi1` from `crank` (explicit)
/// 2. `phi2`, `phi3` from `closure.0`, `closure.1` (dyad of two bars: assembled from both its positions; Newton, 2 × 2 in closed form)
/// 3. `x2` from `coupler_point.0` (explicit)
/// 4. `y2` from `coupler_point.1` (explicit)
///
/// # Cost
/// Operations of each emitted function, on top of the stages before it:
///
/// | function | + − | × | ÷ | sin, cos | other functions | selections |
/// |---|---|---|---|---|---|---|
/// | `parameters` (once a design) | 1 | 0 | 0 | 0 | 0 | 0 |
/// | `position` (once a `(q, t)`) | 2 | 12 | 0 | 3 | 0 | 0 |
/// | `phi` | 10 | 1 | 0 | 0 | 0 | 0 |
/// | `phi_q` | 4 | 0 | 0 | 0 | 0 | 0 |
/// | `phi_t` | 0 | 0 | 0 | 0 | 0 | 0 |
/// | `phi_tt` | 0 | 0 | 0 | 0 | 0 | 0 |
/// | `phi_qt_qd` | 0 | 0 | 0 | 0 | 0 | 0 |
/// | `gamma` | 8 | 11 | 0 | 0 | 0 | 0 |
/// | `branches` | 1 | 2 | 0 | 0 | 0 | 0 |
/// | `limits` | 0 | 0 | 0 | 0 | 0 | 0 |
/// | `outputs` | 3 | 0 | 0 | 0 | 0 | 0 |
/// | `solve_with_position`, once | 4 | 9 | 0 | 1 | 0 | 0 |
/// | `solve_with_position`, each iteration of every block | 7 | 4 | 0 | 2 | 0 | 0 |
///
/// `WorstCase::WORST_CASE_OPERATIONS` is what a step of bounded work costs at most.
#[allow(non_snake_case, reason = "the text names the parameters")]
#[derive(
    ::core::clone::Clone,
    ::core::marker::Copy,
    ::core::fmt::Debug,
    ::core::cmp::PartialEq
)]
pub struct FourBar<T = ::core::primitive::f64> {
    /// Parameter (`rad/s`), default 6.283185307179586.
    pub omega: T,
}
#[allow(clippy::approx_constant, reason = "numbers of the text stay as they are")]
impl<T: ::mbs_runtime::Scalar> ::core::default::Default for FourBar<T> {
    fn default() -> Self {
        Self {
            omega: T::constant(6.283185307179586f64),
        }
    }
}
/// Coordinates of [`FourBar`] by name, in the order of `q`.
#[allow(non_snake_case, reason = "the text names the coordinates")]
#[derive(
    ::core::clone::Clone,
    ::core::marker::Copy,
    ::core::fmt::Debug,
    ::core::cmp::PartialEq
)]
pub struct FourBarCoordinates<T = ::core::primitive::f64> {
    /// Coordinate (`m`).
    pub x2: T,
    /// Coordinate (`m`).
    pub y2: T,
    /// Coordinate (`rad`).
    pub phi1: T,
    /// Coordinate (`rad`).
    pub phi2: T,
    /// Coordinate (`rad`).
    pub phi3: T,
}
impl<T: ::core::marker::Copy> ::core::convert::From<[T; 5usize]>
for FourBarCoordinates<T> {
    fn from(__q: [T; 5usize]) -> Self {
        Self {
            x2: __q[0],
            y2: __q[1],
            phi1: __q[2],
            phi2: __q[3],
            phi3: __q[4],
        }
    }
}
impl<T: ::core::marker::Copy> ::core::convert::From<FourBarCoordinates<T>>
for [T; 5usize] {
    fn from(__named: FourBarCoordinates<T>) -> Self {
        [__named.x2, __named.y2, __named.phi1, __named.phi2, __named.phi3]
    }
}
/// Outputs of [`FourBar`] by name, with their time derivatives.
#[allow(non_snake_case, dead_code, reason = "the text names the outputs")]
#[derive(
    ::core::clone::Clone,
    ::core::marker::Copy,
    ::core::fmt::Debug,
    ::core::cmp::PartialEq
)]
pub struct FourBarOutputs<T = ::core::primitive::f64> {
    /// Output (`rad`).
    pub transmission_angle: ::mbs_runtime::OutputValue<T>,
}
impl<
    T: ::core::marker::Copy,
> ::core::convert::From<[::mbs_runtime::OutputValue<T>; 1usize]> for FourBarOutputs<T> {
    fn from(__outputs: [::mbs_runtime::OutputValue<T>; 1usize]) -> Self {
        Self {
            transmission_angle: __outputs[0],
        }
    }
}
/// Stepper of [`FourBar`]; it is made by `Stepper::assemble`.
#[allow(dead_code, non_camel_case_types, reason = "a short name for who wants it")]
pub type FourBarStepper<T = ::core::primitive::f64> = ::mbs_runtime::Stepper<
    FourBar<T>,
    T,
    5usize,
    5usize,
>;
#[allow(clippy::approx_constant, reason = "numbers of the text stay as they are")]
const _: () = {
    /// Values of parameters alone.
    #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
    pub struct __Parameters<T>([T; 1usize]);
    /// Values of `(q, t)` that functions share.
    #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
    pub struct __Position<T>([T; 18usize]);
    impl<T: ::mbs_runtime::Scalar> ::mbs_runtime::Mechanism<T, 5usize, 5usize>
    for FourBar<T> {
        type Parameters = __Parameters<T>;
        type Position = __Position<T>;
        type Entries = [T; 13usize];
        type Branches = [T; 1usize];
        type Limits = [::mbs_runtime::Limit<T>; 0usize];
        type Phases = [::mbs_runtime::Phase<T>; 0usize];
        type Values = [T; 1usize];
        type Kept = [::core::primitive::f64; 1usize];
        type Outputs = [::mbs_runtime::OutputValue<T>; 1usize];
        type Lane = FourBar<T::Real>;
        const NAME: &'static ::core::primitive::str = "FourBar";
        const SOURCE: &'static ::core::primitive::str = "/// Four-bar linkage with a coupler point.\npub mechanism FourBar;\nconst L1: m = 0.10;\nconst L2: m = 0.25;\nconst L3: m = 0.20;\nconst L4: m = 0.30;\nconst L5: m = 0.15;\nconst ALPHA: rad = 0.4;\nparam omega: rad/s = TAU;\ncoord x2: m;\ncoord y2: m;\ncoord phi1: rad = 0.0;\ncoord phi2: rad = 0.9;\ncoord phi3: rad = 1.8;\nconstraint coupler_point {\n    x2 == L1*cos(phi1) + L5*cos(ALPHA + phi2);\n    y2 == L1*sin(phi1) + L5*sin(ALPHA + phi2);\n}\nconstraint closure {\n    L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);\n    L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);\n}\ndrive crank: phi1 == omega*t;\nbranch open: sin(phi3 - phi2) > 0;\nout transmission_angle: rad = phi3 - phi2;";
        const COORDINATES: &'static [::mbs_runtime::Entry] = &[
            ::mbs_runtime::Entry {
                name: "x2",
                unit: "m",
                line: ::core::line!(),
            },
            ::mbs_runtime::Entry {
                name: "y2",
                unit: "m",
                line: ::core::line!(),
            },
            ::mbs_runtime::Entry {
                name: "phi1",
                unit: "rad",
                line: ::core::line!(),
            },
            ::mbs_runtime::Entry {
                name: "phi2",
                unit: "rad",
                line: ::core::line!(),
            },
            ::mbs_runtime::Entry {
                name: "phi3",
                unit: "rad",
                line: ::core::line!(),
            },
        ];
        const ROWS: &'static [::mbs_runtime::Entry] = &[
            ::mbs_runtime::Entry {
                name: "coupler_point.0",
                unit: "m",
                line: ::core::line!(),
            },
            ::mbs_runtime::Entry {
                name: "coupler_point.1",
                unit: "m",
                line: ::core::line!(),
            },
            ::mbs_runtime::Entry {
                name: "closure.0",
                unit: "m",
                line: ::core::line!(),
            },
            ::mbs_runtime::Entry {
                name: "closure.1",
                unit: "m",
                line: ::core::line!(),
            },
            ::mbs_runtime::Entry {
                name: "crank",
                unit: "rad",
                line: ::core::line!(),
            },
        ];
        #[allow(
            clippy::zero_prefixed_literal,
            reason = "the place of a number of the text, which may begin with 0"
        )]
        const REFERENCE: ::mbs_runtime::Reference = ::mbs_runtime::Reference {
            longest: ::core::option::Option::Some((
                &::mbs_runtime::Entry {
                    name: "L4",
                    unit: "m",
                    line: ::core::line!(),
                },
                0.3f64,
            )),
            parameters: &[],
        };
        const VARIABLES: &'static [::mbs_runtime::Entry] = &[
            ::mbs_runtime::Entry {
                name: "omega",
                unit: "rad/s",
                line: ::core::line!(),
            },
        ];
        const BRANCHES: &'static [::mbs_runtime::Entry] = &[
            ::mbs_runtime::Entry {
                name: "open",
                unit: "1",
                line: ::core::line!(),
            },
        ];
        const BRANCHES_AT_START: &'static [::core::primitive::bool] = &[false];
        const LIMITS: &'static [::mbs_runtime::Entry] = &[];
        const PHASES: &'static [::mbs_runtime::Entry] = &[];
        const OUTPUTS: &'static [::mbs_runtime::Entry] = &[
            ::mbs_runtime::Entry {
                name: "transmission_angle",
                unit: "rad",
                line: ::core::line!(),
            },
        ];
        const SPARSITY: &'static [(::core::primitive::u16, ::core::primitive::u16)] = &[
            (0u16, 0u16),
            (0u16, 2u16),
            (0u16, 3u16),
            (1u16, 1u16),
            (1u16, 2u16),
            (1u16, 3u16),
            (2u16, 2u16),
            (2u16, 3u16),
            (2u16, 4u16),
            (3u16, 2u16),
            (3u16, 3u16),
            (3u16, 4u16),
            (4u16, 2u16),
        ];
        #[inline]
        fn get(&self, __index: ::core::primitive::usize) -> ::core::option::Option<T> {
            match __index {
                0usize => ::core::option::Option::Some(self.omega),
                _ => ::core::option::Option::None,
            }
        }
        #[inline]
        fn set(
            &mut self,
            __index: ::core::primitive::usize,
            __value: T,
        ) -> ::core::primitive::bool {
            match (__index, __value) {
                (0usize, __value) => {
                    self.omega = __value;
                    true
                }
                (_, _) => false,
            }
        }
        #[inline]
        fn values(&self) -> Self::Values {
            [self.omega]
        }
        #[inline]
        fn set_values(&mut self, __values: Self::Values) {
            [self.omega] = __values;
        }
        #[inline]
        fn phases(&self) -> Self::Phases {
            []
        }
        #[inline]
        fn set_phases(&mut self, _: [::mbs_runtime::Phase<T>; 0]) {}
        #[inline]
        fn lane(&self, __lane: ::core::primitive::usize) -> Self::Lane {
            FourBar {
                omega: T::lane(self.omega, __lane),
            }
        }
        const FOLDING: &'static [::core::primitive::u16] = &[0];
        #[inline]
        fn parameters(&self) -> __Parameters<T> {
            let __n59 = -self.omega;
            __Parameters([__n59])
        }
        #[inline]
        fn guess(&self, __p: &__Parameters<T>) -> [T; 5usize] {
            [
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.9f64),
                T::constant(1.8f64),
            ]
        }
        #[inline]
        fn coordinate_scales(&self, __p: &__Parameters<T>) -> [T; 5usize] {
            [
                T::constant(0.3f64),
                T::constant(0.3f64),
                T::constant(1.0f64),
                T::constant(1.0f64),
                T::constant(1.0f64),
            ]
        }
        #[inline]
        fn row_scales(&self, __p: &__Parameters<T>) -> [T; 5usize] {
            [
                T::constant(0.3f64),
                T::constant(0.3f64),
                T::constant(0.3f64),
                T::constant(0.3f64),
                T::constant(1.0f64),
            ]
        }
        #[inline]
        fn position(
            &self,
            __p: &__Parameters<T>,
            __q: &[T; 5usize],
            __t: T,
        ) -> __Position<T> {
            let ([__n23, __n36, __n39], [__n16, __n32, __n29]) = T::sin_cos([
                __q[2],
                __q[3],
                __q[4],
            ]);
            let __n17 = T::constant(0.1f64) * __n16;
            let __n24 = T::constant(0.1f64) * __n23;
            let __n30 = T::constant(0.2f64) * __n29;
            let __n33 = T::constant(0.25f64) * __n32;
            let __n37 = T::constant(0.25f64) * __n36;
            let __n40 = T::constant(0.2f64) * __n39;
            let __n138 = __n36 * T::constant(0.9210609940028851f64);
            let __n139 = __n32 * T::constant(0.3894183423086505f64);
            let __n140 = __n138 + __n139;
            let __n141 = __n32 * T::constant(0.9210609940028851f64);
            let __n142 = __n36 * T::constant(0.3894183423086505f64);
            let __n143 = __n141 - __n142;
            let __n150 = T::constant(0.15f64) * __n143;
            let __n153 = T::constant(0.15f64) * __n140;
            __Position([
                __q[0],
                __q[1],
                __q[2],
                __q[3],
                __q[4],
                __n17,
                __n24,
                __n29,
                __n30,
                __n32,
                __n33,
                __n36,
                __n37,
                __n39,
                __n40,
                __t,
                __n150,
                __n153,
            ])
        }
        #[inline]
        fn phi(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [T; 5usize] {
            let __n31 = T::constant(0.3f64) + __s.0[8];
            let __n34 = __s.0[5] + __s.0[10];
            let __n35 = __n31 - __n34;
            let __n38 = __s.0[6] + __s.0[12];
            let __n41 = __n38 - __s.0[14];
            let __n43 = self.omega * __s.0[15];
            let __n44 = __s.0[2] - __n43;
            let __n151 = __s.0[5] + __s.0[16];
            let __n152 = __s.0[0] - __n151;
            let __n154 = __s.0[6] + __s.0[17];
            let __n155 = __s.0[1] - __n154;
            [__n152, __n155, __n35, __n41, __n44]
        }
        #[inline]
        fn phi_q(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
        ) -> [[T; 5usize]; 5usize] {
            let __n50 = -__s.0[5];
            let __n57 = -__s.0[14];
            let __n58 = -__s.0[8];
            let __n156 = -__s.0[16];
            let mut __rows = [[T::constant(0.0f64); 5]; 5];
            __rows[0][0] = T::constant(1.0f64);
            __rows[0][2] = __s.0[6];
            __rows[0][3] = __s.0[17];
            __rows[1][1] = T::constant(1.0f64);
            __rows[1][2] = __n50;
            __rows[1][3] = __n156;
            __rows[2][2] = __s.0[6];
            __rows[2][3] = __s.0[12];
            __rows[2][4] = __n57;
            __rows[3][2] = __s.0[5];
            __rows[3][3] = __s.0[10];
            __rows[3][4] = __n58;
            __rows[4][2] = T::constant(1.0f64);
            __rows
        }
        #[inline]
        fn phi_q_entries(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
        ) -> [T; 13usize] {
            let __n50 = -__s.0[5];
            let __n57 = -__s.0[14];
            let __n58 = -__s.0[8];
            let __n156 = -__s.0[16];
            [
                T::constant(1.0f64),
                __s.0[6],
                __s.0[17],
                T::constant(1.0f64),
                __n50,
                __n156,
                __s.0[6],
                __s.0[12],
                __n57,
                __s.0[5],
                __s.0[10],
                __n58,
                T::constant(1.0f64),
            ]
        }
        #[inline]
        fn phi_t(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [T; 5usize] {
            [
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.0f64),
                __p.0[0],
            ]
        }
        #[inline]
        fn phi_tt(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [T; 5usize] {
            [
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.0f64),
            ]
        }
        #[inline]
        fn phi_qt_qd(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
            __qd: &[T; 5usize],
        ) -> [T; 5usize] {
            [
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.0f64),
                T::constant(0.0f64),
            ]
        }
        #[inline]
        fn gamma(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
            __qd: &[T; 5usize],
        ) -> [T; 5usize] {
            let __n100 = __qd[2] * __qd[2];
            let __n101 = __s.0[5] * __n100;
            let __n102 = __qd[3] * __qd[3];
            let __n105 = __s.0[6] * __n100;
            let __n111 = __qd[4] * __qd[4];
            let __n112 = __s.0[8] * __n111;
            let __n113 = __s.0[10] * __n102;
            let __n114 = __n101 + __n113;
            let __n116 = __s.0[12] * __n102;
            let __n118 = __n105 + __n116;
            let __n120 = __s.0[14] * __n111;
            let __n124 = __n112 - __n114;
            let __n125 = __n118 - __n120;
            let __n157 = __n102 * __s.0[16];
            let __n158 = __n101 + __n157;
            let __n159 = __n102 * __s.0[17];
            let __n160 = __n105 + __n159;
            let __n161 = -__n160;
            let __n162 = -__n158;
            [__n162, __n161, __n124, __n125, T::constant(0.0f64)]
        }
        #[inline]
        fn evaluate(
            &self,
            __p: &__Parameters<T>,
            __q: &[T; 5usize],
            __t: T,
            __qd: &[T; 5usize],
        ) -> ::mbs_runtime::Evaluation<T, [T; 13usize], 5usize> {
            let __n43 = self.omega * __t;
            let __n44 = __q[2] - __n43;
            let __n100 = __qd[2] * __qd[2];
            let __n102 = __qd[3] * __qd[3];
            let __n111 = __qd[4] * __qd[4];
            let ([__n23, __n36, __n39], [__n16, __n32, __n29]) = T::sin_cos([
                __q[2],
                __q[3],
                __q[4],
            ]);
            let __n17 = T::constant(0.1f64) * __n16;
            let __n24 = T::constant(0.1f64) * __n23;
            let __n30 = T::constant(0.2f64) * __n29;
            let __n31 = T::constant(0.3f64) + __n30;
            let __n33 = T::constant(0.25f64) * __n32;
            let __n34 = __n17 + __n33;
            let __n35 = __n31 - __n34;
            let __n37 = T::constant(0.25f64) * __n36;
            let __n38 = __n24 + __n37;
            let __n40 = T::constant(0.2f64) * __n39;
            let __n41 = __n38 - __n40;
            let __n50 = -__n17;
            let __n57 = -__n40;
            let __n58 = -__n30;
            let __n101 = __n17 * __n100;
            let __n105 = __n24 * __n100;
            let __n112 = __n30 * __n111;
            let __n113 = __n33 * __n102;
            let __n114 = __n101 + __n113;
            let __n116 = __n37 * __n102;
            let __n118 = __n105 + __n116;
            let __n120 = __n40 * __n111;
            let __n124 = __n112 - __n114;
            let __n125 = __n118 - __n120;
            let __n138 = __n36 * T::constant(0.9210609940028851f64);
            let __n139 = __n32 * T::constant(0.3894183423086505f64);
            let __n140 = __n138 + __n139;
            let __n141 = __n32 * T::constant(0.9210609940028851f64);
            let __n142 = __n36 * T::constant(0.3894183423086505f64);
            let __n143 = __n141 - __n142;
            let __n150 = T::constant(0.15f64) * __n143;
            let __n151 = __n17 + __n150;
            let __n152 = __q[0] - __n151;
            let __n153 = T::constant(0.15f64) * __n140;
            let __n154 = __n24 + __n153;
            let __n155 = __q[1] - __n154;
            let __n156 = -__n150;
            let __n157 = __n102 * __n150;
            let __n158 = __n101 + __n157;
            let __n159 = __n102 * __n153;
            let __n160 = __n105 + __n159;
            let __n161 = -__n160;
            let __n162 = -__n158;
            ::mbs_runtime::Evaluation {
                phi: [__n152, __n155, __n35, __n41, __n44],
                phi_q_entries: [
                    T::constant(1.0f64),
                    __n24,
                    __n153,
                    T::constant(1.0f64),
                    __n50,
                    __n156,
                    __n24,
                    __n37,
                    __n57,
                    __n17,
                    __n33,
                    __n58,
                    T::constant(1.0f64),
                ],
                phi_t: [
                    T::constant(0.0f64),
                    T::constant(0.0f64),
                    T::constant(0.0f64),
                    T::constant(0.0f64),
                    __p.0[0],
                ],
                gamma: [__n162, __n161, __n124, __n125, T::constant(0.0f64)],
            }
        }
        #[inline]
        fn branches(&self, __p: &__Parameters<T>, __s: &__Position<T>) -> [T; 1usize] {
            let __n144 = __s.0[9] * __s.0[13];
            let __n145 = __s.0[7] * __s.0[11];
            let __n146 = __n144 - __n145;
            [__n146]
        }
        #[inline]
        fn limits(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
        ) -> [::mbs_runtime::Limit<T>; 0usize] {
            []
        }
        #[inline]
        fn outputs(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
            __qd: &[T; 5usize],
            __qdd: &[T; 5usize],
        ) -> [::mbs_runtime::OutputValue<T>; 1usize] {
            let __n45 = __s.0[4] - __s.0[3];
            let __n126 = __qd[4] - __qd[3];
            let __n129 = __qdd[4] - __qdd[3];
            [
                ::mbs_runtime::OutputValue {
                    value: __n45,
                    rate: ::core::option::Option::Some(__n126),
                    acceleration: ::core::option::Option::Some(__n129),
                },
            ]
        }
    }
    /// Factorised diagonal blocks, and the entries of Φ_q off them.
    #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
    pub struct __Factors<T: ::mbs_runtime::Scalar> {
        /// Entries off the diagonal blocks.
        entries: [T; 5],
        /// Diagonal block 1.
        block1: ::mbs_runtime::Direct2<T>,
    }
    impl<T: ::mbs_runtime::Scalar> ::mbs_runtime::WorstCase for FourBar<T> {
        const WORK: ::mbs_runtime::Work = ::mbs_runtime::Work {
            coordinates: 5usize,
            rows: 5usize,
            entries: 13usize,
            branches: 1usize,
            limits: 0usize,
            phases: 0usize,
            inputs: 0usize,
            variables: 1usize,
            parameters: ::mbs_runtime::Operations {
                additions: 1,
                ..::mbs_runtime::Operations::NONE
            },
            position: ::mbs_runtime::Operations {
                additions: 2,
                multiplications: 12,
                sine_cosines: 3,
                ..::mbs_runtime::Operations::NONE
            },
            phi: ::mbs_runtime::Operations {
                additions: 10,
                multiplications: 1,
                ..::mbs_runtime::Operations::NONE
            },
            phi_q: ::mbs_runtime::Operations {
                additions: 4,
                ..::mbs_runtime::Operations::NONE
            },
            phi_t: ::mbs_runtime::Operations::NONE,
            gamma: ::mbs_runtime::Operations {
                additions: 8,
                multiplications: 11,
                ..::mbs_runtime::Operations::NONE
            },
            branch_values: ::mbs_runtime::Operations {
                additions: 1,
                multiplications: 2,
                ..::mbs_runtime::Operations::NONE
            },
            limit_values: ::mbs_runtime::Operations::NONE,
            phase_speeds: ::mbs_runtime::Operations::NONE,
            coordinate_scales: ::mbs_runtime::Operations::NONE,
            row_scales: ::mbs_runtime::Operations::NONE,
            blocks: &[
                ::mbs_runtime::BlockWork {
                    count: 1usize,
                    unknowns: 0usize,
                    rows: 1usize,
                    before: ::mbs_runtime::Operations {
                        multiplications: 1,
                        ..::mbs_runtime::Operations::NONE
                    },
                    evaluation: ::mbs_runtime::Operations::NONE,
                    ..::mbs_runtime::BlockWork::NONE
                },
                ::mbs_runtime::BlockWork {
                    count: 1usize,
                    unknowns: 2usize,
                    rows: 2usize,
                    before: ::mbs_runtime::Operations {
                        multiplications: 2,
                        sine_cosines: 1,
                        ..::mbs_runtime::Operations::NONE
                    },
                    evaluation: ::mbs_runtime::Operations {
                        additions: 7,
                        multiplications: 4,
                        sine_cosines: 2,
                        ..::mbs_runtime::Operations::NONE
                    },
                    ..::mbs_runtime::BlockWork::NONE
                },
                ::mbs_runtime::BlockWork {
                    count: 2usize,
                    unknowns: 0usize,
                    rows: 1usize,
                    before: ::mbs_runtime::Operations {
                        additions: 2,
                        multiplications: 3,
                        ..::mbs_runtime::Operations::NONE
                    },
                    evaluation: ::mbs_runtime::Operations::NONE,
                    ..::mbs_runtime::BlockWork::NONE
                },
                ::mbs_runtime::BlockWork {
                    count: 1usize,
                    before: ::mbs_runtime::Operations::NONE,
                    ..::mbs_runtime::BlockWork::NONE
                },
            ],
        };
    }
    impl<T: ::mbs_runtime::Scalar> ::mbs_runtime::Kinematic<T, 5usize> for FourBar<T> {
        type Factors = __Factors<T>;
        type GroupNumber = <T::Real as ::mbs_runtime::Real>::Register;
        type Group = FourBar<<T::Real as ::mbs_runtime::Real>::Register>;
        #[inline]
        fn group(&self, __first: ::core::primitive::usize) -> Self::Group {
            FourBar {
                omega: T::part(self.omega, __first),
            }
        }
        #[inline]
        fn solve_blocks<__S: ::mbs_runtime::BlockSolver<T>>(
            &self,
            __p: &__Parameters<T>,
            __q: &mut [T; 5usize],
            __t: T,
            __solver: &mut __S,
        ) -> T::Lanes<::mbs_runtime::Outcome> {
            ::mbs_runtime::Kinematic::solve_with_position(self, __p, __q, __t, __solver)
                .0
        }
        #[inline(always)]
        fn solve_with_position<__S: ::mbs_runtime::BlockSolver<T>>(
            &self,
            __p: &__Parameters<T>,
            __q: &mut [T; 5usize],
            __t: T,
            __solver: &mut __S,
        ) -> (T::Lanes<::mbs_runtime::Outcome>, __Position<T>) {
            let __outcome = T::per_lane(|_| ::mbs_runtime::Outcome::Converged);
            let __n43 = self.omega * __t;
            __q[2] = __n43;
            let ([__n23], [__n16]) = T::sin_cos([__q[2]]);
            let __n17 = T::constant(0.1f64) * __n16;
            let __n24 = T::constant(0.1f64) * __n23;
            let __kept = ::core::cell::Cell::new((
                [T::constant(::core::primitive::f64::INFINITY); 2],
                [T::constant(0.0f64); 8],
            ));
            let mut __evaluate = {
                #[inline(always)]
                |__x: &[T; 2]| {
                    let ([__n36, __n39], [__n32, __n29]) = T::sin_cos([__x[0], __x[1]]);
                    let __n30 = T::constant(0.2f64) * __n29;
                    let __n31 = T::constant(0.3f64) + __n30;
                    let __n33 = T::constant(0.25f64) * __n32;
                    let __n34 = __n17 + __n33;
                    let __n35 = __n31 - __n34;
                    let __n37 = T::constant(0.25f64) * __n36;
                    let __n38 = __n24 + __n37;
                    let __n40 = T::constant(0.2f64) * __n39;
                    let __n41 = __n38 - __n40;
                    let __n57 = -__n40;
                    let __n58 = -__n30;
                    __kept
                        .set((
                            *__x,
                            [__n29, __n30, __n32, __n33, __n36, __n37, __n39, __n40],
                        ));
                    ([__n35, __n41], [[__n37, __n57], [__n33, __n58]])
                }
            };
            let (__x, __block) = __solver
                .solve_closed::<
                    2,
                    ::mbs_runtime::Direct2<T>,
                >(
                    &::mbs_runtime::Block {
                        rows: [2, 3],
                        coordinates: [3, 4],
                        angles: [true, true],
                        row_scales: [T::constant(0.3f64), T::constant(0.3f64)],
                        coordinate_scales: [T::constant(1.0f64), T::constant(1.0f64)],
                    },
                    [__q[3], __q[4]],
                    #[inline(always)]
                    |__x| {
                        if __S::INLINED_PER_BLOCK {
                            __evaluate(__x)
                        } else {
                            ::mbs_runtime::__private::call_never_inlined(
                                &mut __evaluate,
                                __x,
                            )
                        }
                    },
                    |__x| {
                        let ([__n36, __n39], [__n32, __n29]) = T::sin_cos([
                            __x[0],
                            __x[1],
                        ]);
                        let __n144 = __n32 * __n39;
                        let __n145 = __n29 * __n36;
                        let __n146 = __n144 - __n145;
                        T::less(T::constant(0.0f64), __n146)
                    },
                    |__near| {
                        let __n132 = T::constant(0.3f64) - __n17;
                        ::mbs_runtime::Dyad::Bars {
                            a: [
                                [T::constant(0.2f64), T::constant(0.0f64)],
                                [T::constant(0.0f64), T::constant(-0.2f64)],
                            ],
                            b: [
                                [T::constant(-0.25f64), T::constant(0.0f64)],
                                [T::constant(0.0f64), T::constant(0.25f64)],
                            ],
                            c: [__n132, __n24],
                            unknowns: [[0.0, 1.0], [1.0, 0.0]],
                        }
                            .roots(__near)
                    },
                );
            let mut __values = __kept.get();
            if !__S::INLINED_PER_BLOCK
                && !::mbs_runtime::__private::is_same(&__values.0, &__x)
            {
                ::mbs_runtime::__private::call_never_inlined(&mut __evaluate, &__x);
                __values = __kept.get();
            }
            let [__n29, __n30, __n32, __n33, __n36, __n37, __n39, __n40] = __values.1;
            __q[3] = __x[0];
            __q[4] = __x[1];
            let __outcome = ::mbs_runtime::__private::first_failure::<
                T,
            >(__outcome, __block);
            let __n141 = __n32 * T::constant(0.9210609940028851f64);
            let __n142 = __n36 * T::constant(0.3894183423086505f64);
            let __n143 = __n141 - __n142;
            let __n150 = T::constant(0.15f64) * __n143;
            let __n151 = __n17 + __n150;
            __q[0] = __n151;
            let __n138 = __n36 * T::constant(0.9210609940028851f64);
            let __n139 = __n32 * T::constant(0.3894183423086505f64);
            let __n140 = __n138 + __n139;
            let __n153 = T::constant(0.15f64) * __n140;
            let __n154 = __n24 + __n153;
            __q[1] = __n154;
            (
                __outcome,
                __Position([
                    __q[0],
                    __q[1],
                    __q[2],
                    __q[3],
                    __q[4],
                    __n17,
                    __n24,
                    __n29,
                    __n30,
                    __n32,
                    __n33,
                    __n36,
                    __n37,
                    __n39,
                    __n40,
                    __t,
                    __n150,
                    __n153,
                ]),
            )
        }
        #[inline(always)]
        fn factorize(
            &self,
            __p: &__Parameters<T>,
            __s: &__Position<T>,
        ) -> (__Factors<T>, ::mbs_runtime::Margin<T>) {
            let __n50 = -__s.0[5];
            let __n57 = -__s.0[14];
            let __n58 = -__s.0[8];
            let __n156 = -__s.0[16];
            let __margin = ::mbs_runtime::Margin::<T>::regular();
            let (__block1, __value) = <::mbs_runtime::Direct2<
                T,
            > as ::mbs_runtime::Factorization<
                T,
                2,
            >>::factorize(
                &[[__s.0[12], __n57], [__s.0[10], __n58]],
                &[T::constant(1.0f64), T::constant(1.0f64)],
                &[T::constant(1.0f64), T::constant(1.0f64)],
            );
            let __margin = __margin
                .with_block(__value, 2, 3)
                .oriented(
                    <::mbs_runtime::Direct2<
                        T,
                    > as ::mbs_runtime::Factorization<T, 2>>::reverses(&__block1),
                );
            (
                __Factors {
                    entries: [__s.0[5], __s.0[6], __n50, __s.0[17], __n156],
                    block1: __block1,
                },
                __margin,
            )
        }
        #[inline(always)]
        fn solve_linear(
            &self,
            __factors: &__Factors<T>,
            __b: &[T; 5usize],
        ) -> [T; 5usize] {
            let __x2 = __b[4];
            let [__x3, __x4] = <::mbs_runtime::Direct2<
                T,
            > as ::mbs_runtime::Factorization<
                T,
                2,
            >>::solve(
                &__factors.block1,
                &[
                    __b[2] - __factors.entries[1] * __x2,
                    __b[3] - __factors.entries[0] * __x2,
                ],
            );
            let __x0 = __b[0] - __factors.entries[1] * __x2
                - __factors.entries[3] * __x3;
            let __x1 = __b[1] - __factors.entries[2] * __x2
                - __factors.entries[4] * __x3;
            [__x0, __x1, __x2, __x3, __x4]
        }
    }
};
impl<T: ::mbs_runtime::Scalar> ::mbs_runtime::Reveal<T> for FourBar<T> {
    fn reveal<__V: ::mbs_runtime::Visitor<Self, T>>(
        self,
        __visitor: __V,
    ) -> __V::Output {
        __visitor.kinematic::<5usize, 5usize>(self)
    }
}
impl<__U: ::mbs_runtime::Scalar> ::mbs_runtime::InNumbers<__U>
for FourBar<::core::primitive::f64> {
    type Mechanism = FourBar<__U>;
    fn in_numbers(&self) -> Self::Mechanism {
        FourBar {
            omega: __U::constant(self.omega),
        }
    }
}
