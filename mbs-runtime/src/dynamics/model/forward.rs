//! Functions of formulations and methods that another value does.

/// Functions of [`Formulation`](crate::dynamics::model::Formulation) and [`Method`](crate::dynamics::model::method::Method), done
/// by a value that `|it| …` makes of `self`. Types have their names at the place of the call.
macro_rules! forward {
    (|$it:pat_param| $to:expr => $($name:ident),+) => {
        $(forward! { @$name $it, $to })+
    };
    (@solve $($by:tt)+) => {
        forward! { ($($by)+) solve(
            model: &Model<'_, S, R, N, M>, t: R, y: &IntegratorState<R, N, S::States>, lambda: &[R; M], counts: &mut Counts
        ) -> Result<Solved<R, N, M, S::States>, Failure> }
    };
    (@solve_as_it_is $($by:tt)+) => {
        forward! { ($($by)+) solve_as_it_is(
            model: &Model<'_, S, R, N, M>, t: R, y: &IntegratorState<R, N, S::States>, lambda: &[R; M], counts: &mut Counts
        ) -> Result<Solved<R, N, M, S::States>, Failure> }
    };
    (@project $($by:tt)+) => {
        forward! { ($($by)+) project(
            model: &Model<'_, S, R, N, M>, t: R, y: &mut IntegratorState<R, N, S::States>, counts: &mut Counts
        ) -> Result<(), Failure> }
    };
    (@project_and_solve $($by:tt)+) => {
        forward! { ($($by)+) project_and_solve(
            model: &Model<'_, S, R, N, M>, t: R, y: &mut IntegratorState<R, N, S::States>, lambda: &[R; M], counts: &mut Counts
        ) -> Result<Solved<R, N, M, S::States>, Failure> }
    };
    (@step $($by:tt)+) => {
        forward! { ($($by)+) step(
            model: &Model<'_, S, R, N, M>, from: &Instant<R, N, M, S::States>, h: R, counts: &mut Counts
        ) -> Result<Instant<R, N, M, S::States>, Failure> }
    };
    (@steps_over_modes $($by:tt)+) => {
        forward! { ($($by)+) steps_over_modes() -> bool }
    };
    (@step_in_modes $($by:tt)+) => {
        forward! { ($($by)+) step_in_modes(
            model: &Model<'_, S, R, N, M>, from: &Instant<R, N, M, S::States>, h: R, counts: &mut Counts
        ) -> Result<SteppedInModes<R, S::Parameters, N, M, S::States>, Failure> }
    };
    (@phases_after $($by:tt)+) => {
        forward! { ($($by)+) phases_after(
            model: &Model<'_, S, R, N, M>, t: R, h: R
        ) -> Result<Option<S::Phases>, Failure> }
    };
    (@require_suitable $($by:tt)+) => {
        forward! { ($($by)+) require_suitable() -> Result<(), Failure> }
    };
    (@check_step $($by:tt)+) => {
        forward! { ($($by)+) check_step(h: R, t: R) -> Result<(), Failure> }
    };
    (@leaves_constraints $($by:tt)+) => {
        forward! { ($($by)+) leaves_constraints() -> bool }
    };
    (@doubt $($by:tt)+) => {
        forward! { ($($by)+) doubt(h: R, span: R) -> Option<MethodWarning> }
    };
    (($it:pat_param, $to:expr) $name:ident($($argument:ident: $type:ty),*) -> $found:ty) => {
        fn $name(&self $(, $argument: $type)*) -> $found {
            let $it = self;
            $to.$name($($argument),*)
        }
    };
}

pub(crate) use forward;
