//! Order 8 with estimates of orders 5 and 3: the method for accuracies of 1e-7 and beyond.

use crate::dynamics::integrators::embedded::{Embedded, StepAttempt, StepControl, Taken, hermite, nested};
use crate::dynamics::integrators::equation::{Equation, ErrorNorm};
use crate::dynamics::integrators::fixed_step::FixedStep;
use crate::dynamics::integrators::vector::Vector;
use crate::failure::Failure;
use crate::scalar::number::{Real, Scalar};

/// The method of order 8 of Dormand and Prince, twelve stages, with dense output of order 7 from three more.
///
/// Source: Hairer, Nørsett & Wanner 1993, §II.5 and §II.6, code DOP853.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DormandPrince8;

/// Nodes cᵢ of the stages, as shares of the step.
const C: [f64; 16] = [
    0.0,
    0.05260015195876773,
    0.0789002279381516,
    0.1183503419072274,
    0.2816496580927726,
    0.3333333333333333,
    0.25,
    0.3076923076923077,
    0.6512820512820513,
    0.6,
    0.8571428571428571,
    1.0,
    1.0,
    0.1,
    0.2,
    0.7777777777777778,
];
/// Of stages 1.
const A2: [f64; 1] = [0.05260015195876773];
/// Of stages 1, 2.
const A3: [f64; 2] = [0.0197250569845379, 0.0591751709536137];
/// Of stages 1, 3.
const A4: [f64; 2] = [0.02958758547680685, 0.08876275643042054];
/// Of stages 1, 3, 4.
const A5: [f64; 3] = [0.2413651341592667, -0.8845494793282861, 0.924834003261792];
/// Of stages 1, 4, 5.
const A6: [f64; 3] = [0.037037037037037035, 0.17082860872947386, 0.12546768756682242];
/// Of stages 1, 4, 5, 6.
const A7: [f64; 4] = [0.037109375, 0.17025221101954405, 0.06021653898045596, -0.017578125];
/// Of stages 1, 4, 5, 6, 7.
const A8: [f64; 5] = [
    0.03709200011850479,
    0.17038392571223998,
    0.10726203044637328,
    -0.015319437748624402,
    0.008273789163814023,
];
/// Of stages 1, 4, 5, 6, 7, 8.
const A9: [f64; 6] = [
    0.6241109587160757,
    -3.3608926294469414,
    -0.868219346841726,
    27.59209969944671,
    20.154067550477894,
    -43.48988418106996,
];
/// Of stages 1, 4, 5, 6, 7, 8, 9.
const A10: [f64; 7] = [
    0.47766253643826434,
    -2.4881146199716677,
    -0.590290826836843,
    21.230051448181193,
    15.279233632882423,
    -33.28821096898486,
    -0.020331201708508627,
];
/// Of stages 1, 4, 5, 6, 7, 8, 9, 10.
const A11: [f64; 8] = [
    -0.9371424300859873,
    5.186372428844064,
    1.0914373489967295,
    -8.149787010746927,
    -18.52006565999696,
    22.739487099350505,
    2.4936055526796523,
    -3.0467644718982196,
];
/// Of stages 1, 4, 5, 6, 7, 8, 9, 10, 11.
const A12: [f64; 9] = [
    2.273310147516538,
    -10.53449546673725,
    -2.0008720582248625,
    -17.9589318631188,
    27.94888452941996,
    -2.8589982771350235,
    -8.87285693353063,
    12.360567175794303,
    0.6433927460157636,
];
/// The solution, of stages 1, 6, 7, 8, 9, 10, 11, 12.
const B: [f64; 8] = [
    0.054293734116568765,
    4.450312892752409,
    1.8915178993145003,
    -5.801203960010585,
    0.3111643669578199,
    -0.1521609496625161,
    0.20136540080403034,
    0.04471061572777259,
];
/// Of stages 1, 7, 8, 9, 10, 11, 12, 13.
const A14: [f64; 8] = [
    0.056167502283047954,
    0.25350021021662483,
    -0.2462390374708025,
    -0.12419142326381637,
    0.15329179827876568,
    0.00820105229563469,
    0.007567897660545699,
    -0.008298,
];
/// Of stages 1, 6, 7, 8, 11, 12, 13, 14.
const A15: [f64; 8] = [
    0.03183464816350214,
    0.028300909672366776,
    0.053541988307438566,
    -0.05492374857139099,
    -0.00010834732869724932,
    0.0003825710908356584,
    -0.00034046500868740456,
    0.1413124436746325,
];
/// Of stages 1, 6, 7, 8, 9, 13, 14, 15.
const A16: [f64; 8] = [
    -0.42889630158379194,
    -4.697621415361164,
    7.683421196062599,
    4.06898981839711,
    0.3567271874552811,
    -0.0013990241651590145,
    2.9475147891527724,
    -9.15095847217987,
];
/// Solution of order 8 less the one of order 3, of stages 1, 6, 7, 8, 9, 10, 11, 12.
const E3: [f64; 8] = [
    -0.18980075407240762,
    4.450312892752409,
    1.8915178993145003,
    -5.801203960010585,
    -0.4226823213237919,
    -0.1521609496625161,
    0.20136540080403034,
    0.02265179219836082,
];
/// Solution of order 8 less the one of order 5, of stages 1, 6, 7, 8, 9, 10, 11, 12.
const E5: [f64; 8] = [
    0.01312004499419488,
    -1.2251564463762044,
    -0.4957589496572502,
    1.6643771824549864,
    -0.35032884874997366,
    0.3341791187130175,
    0.08192320648511571,
    -0.022355307863886294,
];
/// Coefficient 4 of the dense output of stages 1, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16.
const D4: [f64; 12] = [
    -8.428938276109013,
    0.5667149535193777,
    -3.0689499459498917,
    2.38466765651207,
    2.117034582445028,
    -0.871391583777973,
    2.2404374302607883,
    0.6315787787694688,
    -0.08899033645133331,
    18.148505520854727,
    -9.194632392478356,
    -4.436036387594894,
];
/// Coefficient 5 of stages 1, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16.
const D5: [f64; 12] = [
    10.427508642579134,
    242.28349177525817,
    165.20045171727028,
    -374.5467547226902,
    -22.113666853125306,
    7.733432668472264,
    -30.674084731089398,
    -9.332130526430229,
    15.697238121770845,
    -31.139403219565178,
    -9.35292435884448,
    35.81684148639408,
];
/// Coefficient 6 of stages 1, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16.
const D6: [f64; 12] = [
    19.985053242002433,
    -387.0373087493518,
    -189.17813819516758,
    527.8081592054236,
    -11.57390253995963,
    6.8812326946963,
    -1.0006050966910838,
    0.7777137798053443,
    -2.778205752353508,
    -60.19669523126412,
    84.32040550667716,
    11.99229113618279,
];
/// Coefficient 7 of stages 1, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16.
const D7: [f64; 12] = [
    -25.69393346270375,
    -154.18974869023643,
    -231.5293791760455,
    357.6391179106141,
    93.40532418362432,
    -37.45832313645163,
    104.0996495089623,
    29.8402934266605,
    -43.53345659001114,
    96.32455395918828,
    -39.17726167561544,
    -149.72683625798564,
];

/// Weight of the estimate of order 3 relative to the one of order 5.
const THIRD_ORDER_SHARE: f64 = 0.01;

impl FixedStep for DormandPrince8 {
    #[inline]
    fn order(&self) -> u32 {
        8
    }

    /// The solution of order 8, whatever its error.
    #[inline]
    fn step<T: Scalar, S: Equation<T>>(
        &self,
        equation: &mut S,
        t: T,
        h: T,
        y: &S::State,
        rate: &S::State,
    ) -> Result<S::State, Failure> {
        Ok(self.trial(equation, (t, h), (y, rate), &())?.y)
    }
}

impl Embedded for DormandPrince8 {
    /// Stages 6 to 12.
    type Stages<Y: Copy> = [Y; 7];
    type Memory<R: Copy, Y: Copy> = ();
    type Dense<Y: Copy> = [Y; 8];

    /// The estimate of order 5 changes its sign now and then, and with it the error goes through zero. A step that then grows six
    /// times may meet the next such place: of 100 motions of one crank at 1e-8 two were 30 times as far off as the others.
    #[inline]
    fn control(&self) -> StepControl {
        StepControl { largest_growth_in_tune: 2.0, ..StepControl::of(8, 6.0) }
    }

    #[inline]
    fn trial<T: Scalar, S: Equation<T>>(
        &self,
        equation: &mut S,
        (t, h): (T, T),
        (y, k1): (&S::State, &S::State),
        _: &(),
    ) -> Result<StepAttempt<S::State, [S::State; 7]>, Failure> {
        let [_, c2, c3, c4, c5, c6, c7, c8, c9, c10, c11, ..] = C;
        let at = |c: f64| t + T::constant(c) * h;
        let k2 = equation.rate(at(c2), &y.plus(h, &A2, [k1]))?;
        let k3 = equation.rate(at(c3), &y.plus(h, &A3, [k1, &k2]))?;
        let k4 = equation.rate(at(c4), &y.plus(h, &A4, [k1, &k3]))?;
        let k5 = equation.rate(at(c5), &y.plus(h, &A5, [k1, &k3, &k4]))?;
        let k6 = equation.rate(at(c6), &y.plus(h, &A6, [k1, &k4, &k5]))?;
        let k7 = equation.rate(at(c7), &y.plus(h, &A7, [k1, &k4, &k5, &k6]))?;
        let k8 = equation.rate(at(c8), &y.plus(h, &A8, [k1, &k4, &k5, &k6, &k7]))?;
        let k9 = equation.rate(at(c9), &y.plus(h, &A9, [k1, &k4, &k5, &k6, &k7, &k8]))?;
        let k10 = equation.rate(at(c10), &y.plus(h, &A10, [k1, &k4, &k5, &k6, &k7, &k8, &k9]))?;
        let k11 = equation.rate(at(c11), &y.plus(h, &A11, [k1, &k4, &k5, &k6, &k7, &k8, &k9, &k10]))?;
        let last = y.plus(h, &A12, [k1, &k4, &k5, &k6, &k7, &k8, &k9, &k10, &k11]);
        let k12 = equation.rate(t + h, &last)?;
        let next = y.plus(h, &B, [k1, &k6, &k7, &k8, &k9, &k10, &k11, &k12]);
        Ok(StepAttempt { y: next, stages: [k6, k7, k8, k9, k10, k11, k12] })
    }

    #[inline]
    fn remember<R: Real, Y: Vector<R>>(_: &Taken<'_, R, Y, [Y; 7]>) {}

    /// e₅²/√(e₅² + 0.01 e₃²) of the two estimates.
    #[inline]
    fn error<R: Real, S: ErrorNorm<R>>(
        equation: &S,
        h: R,
        y: &S::State,
        k1: &S::State,
        trial: &StepAttempt<S::State, [S::State; 7]>,
    ) -> R {
        let [k6, k7, k8, k9, k10, k11, k12] = &trial.stages;
        let stages = [k1, k6, k7, k8, k9, k10, k11, k12];
        let (fifth, third) = (y.zero().plus(h, &E5, stages), y.zero().plus(h, &E3, stages));
        let [fifth, third] = equation.measure(y, &trial.y, [&fifth, &third]);
        let bound = (fifth * fifth + R::constant(THIRD_ORDER_SHARE) * third * third).sqrt();
        if R::constant(0.0) < bound { fifth * fifth / bound } else { bound }
    }

    fn dense<R: Real, S: Equation<R>>(
        equation: &mut S,
        step: &Taken<'_, R, S::State, [S::State; 7]>,
    ) -> Result<[S::State; 8], Failure> {
        let (Taken { t, h, .. }, (y, k1), (_, k13)) = (*step, step.start, step.end);
        let [k6, k7, k8, k9, k10, k11, k12] = step.stages;
        let [.., c14, c15, c16] = C;
        let at = |c: f64| t + R::constant(c) * h;
        let k14 = equation.rate(at(c14), &y.plus(h, &A14, [k1, k7, k8, k9, k10, k11, k12, k13]))?;
        let k15 = equation.rate(at(c15), &y.plus(h, &A15, [k1, k6, k7, k8, k11, k12, k13, &k14]))?;
        let k16 = equation.rate(at(c16), &y.plus(h, &A16, [k1, k6, k7, k8, k9, k13, &k14, &k15]))?;
        let stages = [k1, k6, k7, k8, k9, k10, k11, k12, k13, &k14, &k15, &k16];
        let [change, bend, twist] = hermite(h, step.start, step.end);
        let sums = [D4, D5, D6, D7].map(|weights| y.zero().plus(h, &weights, stages));
        let [fourth, fifth, sixth, seventh] = sums;
        Ok([*y, change, bend, twist, fourth, fifth, sixth, seventh])
    }

    #[inline]
    fn interpolate<T: Scalar, Y: Vector<T>>([start, terms @ .., last]: &[Y; 8], theta: T) -> Y {
        nested(start, (terms, last), theta)
    }
}
