#[test]
fn casadi_and_50_digits_confirm_my_mechanism() {
    let mine = my_crate::Mine::default();
    println!("{}", mbs_workbench::verify::check(mine).unwrap());
}
