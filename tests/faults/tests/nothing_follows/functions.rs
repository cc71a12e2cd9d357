use mbs_runtime::driver::Polynomial;
use mbs_runtime::{Failure, Function, Mechanism, Stepper};
struct Held<Lift, Wear> { follower: Follower<Lift, Wear, f64> }
fn run<Lift, Wear>(lift: Lift, wear: Wear) -> Result<f64, Failure>
where
    Lift: Function<f64> + Clone + Copy,
    Wear: Function<f64> + Clone + Copy,
{
    let follower = Follower { base: 0.02, ..Follower::new(lift, [wear, wear]) };
    let guess = follower.guess(&follower.parameters());
    let mut motion = Stepper::assemble(follower, guess, 0.0)?;
    motion.advance(0.1)?;
    let [x, y] = motion.outputs();
    let held = Held { follower };
    let FollowerCoordinates { theta, y: height } = FollowerCoordinates::from(*motion.q());
    Ok(x.value + y.value + theta + height + held.follower.omega)
}
