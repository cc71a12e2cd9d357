//! Times at which events of a text begin and end in a run.

use mbs_runtime::dynamics::{Method, Simulation};
use mbs_runtime::{Dynamic, Failure, Real};

/// Most halvings of the time between two instants of a run: 52 take it to the digits of `f64`.
const HALVINGS: usize = 60;

/// Time that is not halved, over the time itself, in ε of the number and of `f64`: steps below it are of no length.
const ROUNDING: f64 = 16.0;

/// Events that hold at the present instant of a run.
fn holding<S, X, R, const N: usize, const M: usize>(run: &Simulation<S, X, R, N, M>) -> Vec<bool>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    let parameters = run.parameters_with_forces();
    S::remembered(&parameters).iter().take(S::EVENTS.len()).map(|value| value.to_f64() != 0.0).collect()
}

/// Adds to the lists of `found`, one an event, each time (s) at which it begins or ends between the present instants of `from` and
/// `to`. `advance` takes a run to a time.
///
/// # Errors
/// Those of `advance`.
pub fn add_changes<S, X, R, const N: usize, const M: usize>(
    (from, to): (&Simulation<S, X, R, N, M>, &Simulation<S, X, R, N, M>),
    found: &mut [Vec<f64>],
    advance: impl Fn(&mut Simulation<S, X, R, N, M>, R) -> Result<(), Failure>,
) -> Result<(), Failure>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
    Simulation<S, X, R, N, M>: Clone,
{
    let mut low = from.clone();
    let last = holding(to);
    // Each event changes once at most in the rest of the time, for the search sees both ends alone.
    for _ in 0..S::EVENTS.len() {
        let held = holding(&low);
        if held == last {
            return Ok(());
        }
        let mut high = to.clone();
        for _ in 0..HALVINGS {
            let [before, after] = [&low, &high].map(|run| run.t().to_f64());
            if after - before <= ROUNDING * R::EPSILON.to_f64().max(f64::EPSILON) * after.abs() {
                break;
            }
            let middle = R::constant(0.5 * (before + after));
            let mut tried = low.clone();
            advance(&mut tried, middle)?;
            if holding(&tried) == held { low = tried } else { high = tried }
        }
        let next = holding(&high);
        for ((times, held), next) in found.iter_mut().zip(&held).zip(&next) {
            if held != next {
                times.push(high.t().to_f64());
            }
        }
        low = high;
    }
    Ok(())
}
