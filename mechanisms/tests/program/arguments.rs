//! Arguments and readers that a command cannot serve.

use super::*;

#[test]
fn options_that_an_analysis_has_no_use_for_are_refused() {
    let cases: [(&[&str], &str); 21] = [
        (&["equilibrium", "pendulum", "--until", "3"], "unexpected argument '--until'"),
        (&["equilibrium", "pendulum", "--steps", "3"], "unexpected argument '--steps'"),
        (&["equilibrium", "pendulum", "--at", "0.3"], "unexpected argument '--at'"),
        (&["simulate", "pendulum", "--guess", "P.0=1"], "unexpected argument '--guess'"),
        (&["kinematics", "four_bar", "--method", "velocity"], "unexpected argument '--method'"),
        (&["modes", "pendulum", "--at", "1", "--until", "2"], "unexpected argument '--until'"),
        (&["modes", "pendulum", "--at", "0.3", "--guess", "P.0=1"], "cannot be used with"),
        (&["modes", "pendulum", "--steps", "3"], "--at <T>"),
        (&["modes", "pendulum", "--method", "none"], "use `mbs simulate`, or `mbs modes` with `--at`"),
        (
            &["run", "four_bar", "--method", "velocity"],
            "`--method` is how a motion from forces is integrated",
        ),
        (
            &["run", "four_bar", "--integrator", "rk4"],
            "`--integrator` is how a motion from forces is integrated",
        ),
        (
            &["run", "four_bar", "--tolerance", "1e-3"],
            "`--tolerance` is how a motion from forces is integrated",
        ),
        (&["simulate", "pendulum", "--step", "0.1"], "adaptive steps take `--tolerance`"),
        (&["simulate", "pendulum", "--frequency", "3"], "belong to `--method baumgarte` or `penalty`"),
        (
            &["simulate", "pendulum", "--method", "extrapolated", "--tolerance", "1e-3"],
            "this method takes `--step`",
        ),
        (
            &["simulate", "pendulum", "--method", "extrapolated", "--integrator", "rk4"],
            "others take `--step`",
        ),
        (&["simulate", "pendulum", "--integrator", "rk4", "--tolerance", "1e-3"], "equal ones take `--step`"),
        (
            &["simulate", "pendulum", "--method", "baumgarte", "--alpha", "1e5"],
            "belongs to `--method penalty`",
        ),
        (&["simulate", "pendulum", "--method", "penalty", "--alpha", "1e9"], "at most 1e8"),
        (&["equilibrium", "pendulum", "--guess", "P=1"], "it is an array, `P.0`, `P.1`"),
        (&["equilibrium", "four_bar"], "neither masses nor forces"),
    ];
    for (arguments, words) in cases {
        let message = failure(mbs(arguments), 2);
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
    assert!(failure(mbs(&["modes", "pendulum", "--at", "-1"]), 2).contains("at least 0"));
    assert!(failure(mbs(&["equilibrium", "pendulum", "--guess", "P.0=far"]), 2).contains("not a number"));
}

#[test]
fn a_mechanism_that_cannot_be_assembled_says_so_and_leaves_no_report() {
    let scratch = Scratch::new("impossible");
    let message = failure(run_into(&scratch, &["run", "four_bar", "--param", "L2=0.05"]), 1);
    assert!(message.contains("cannot be assembled") && message.contains("closure"), "{message}");
    assert!(!scratch.0.exists());
}

#[test]
fn an_unknown_mechanism_gets_a_proposal() {
    for command in ["run", "expand", "verify"] {
        let message = failure(mbs(&[command, "slidercrank"]), 2);
        assert!(
            message.contains("did you mean `slider_crank`?") && message.contains("open_chain"),
            "{message}"
        );
    }
}

#[test]
fn an_end_that_no_one_waits_for_is_refused_after_a_thousand_steps() {
    let message = failure(mbs(&["run", "pendulum", "--until", "1e9"]), 1);
    assert!(message.contains("t = 1e9 s is out of reach"), "{message}");
}

#[test]
fn senseless_arguments_are_refused_in_plain_words() {
    let cases: [(&[&str], &str); 37] = [
        (&["run", "four_bar", "--until", "-1"], "a number above 0"),
        (&["run", "pendulum", "--step", "-1"], "a number above 0"),
        (&["run", "pendulum", "--tolerance", "-1"], "a number above 0"),
        (&["run", "pendulum", "--tolerance", "1e-30"], "at least 3.6e-15 is possible"),
        (
            &["run", "pendulum", "--until", "0.01", "--integrator", "rk4", "--step", "1e-14"],
            "t = 0.01 s are 1.0e12, more than the 1e8 of a run",
        ),
        (&["run", "pendulum", "--until", "1e9", "--integrator", "rk4"], "let them adapt"),
        (&["run", "governor", "--until", "1e9"], "take longer ones by `--step`"),
        (&["run", "pendulum", "--steps", "-1"], "whole number"),
        (&["run", "pendulum", "--param", "m=-1"], "`mass` of `bob` is negative: -1"),
        (&["run", "quarter_car", "--param", "k.0=-5"], "`stiffness` of `"),
        (&["drift", "pendulum", "--integrator", "order5"], "use `--integrator rk4` or `euler`"),
        (&["simulate", "pendulum", "--method", "rk4"], "write `--integrator rk4`"),
        (&["simulate", "pendulum", "--integrator", "radau"], "write `--method radau`"),
        (&["print", "four_bar", "M"], "neither masses nor forces"),
        (&["run", "four_bar", "--steps", "0"], "at least 1"),
        (&["run", "four_bar", "--steps", "many"], "whole number"),
        (&["run", "four_bar", "--param", "omega"], "NAME=VALUE"),
        (&["run", "four_bar", "--param", "omega=nan"], "finite"),
        (&["run", "four_bar", "--param", "omega=1e999"], "finite"),
        (&["run", "four_bar", "--param", "omega=two"], "not a number"),
        (&["run", "four_bar", "--param", "omgea=2"], "did you mean `omega`?"),
        (&["run", "four_bar", "--param", "L1=60rpm"], "`L1` is in `m`, `60rpm` is in `1/s`"),
        (&["run", "four_bar", "--param", "L1=200 mm"], "write `200mm`"),
        (&["run", "four_bar", "--param", "L1=-0.1"], "a link has no negative length"),
        (&["run", "four_bar", "--param", "L1=1e-300"], "lost in rounding"),
        (&["kinematics", "slider_crank", "--param", "r=-5cm"], "a link has no negative length"),
        (&["run", "andrews", "--param", "m=1"], "it is an array, `m.0` … `m.6`"),
        (&["equilibrium", "pendulum", "--guess", "P.0=2kg"], "`P.0` is in `m`, `2kg` is in `kg`"),
        (&["run", "FOUR_BAR"], "did you mean `four_bar`?"),
        (&["run", "four-bar"], "did you mean `four_bar`?"),
        (&["four_bar"], "`mbs run four_bar`"),
        (&["Four_Bar"], "`mbs run four_bar`"),
        (&["simulat", "pendulum"], "'simulate'"),
        (&["structure", "four_bar", "--out", "x.png"], "name it FILE.svg"),
        (&["run", "four_bar", "--param", "omega=0"], "never ends"),
        (&["verify"], "required"),
        (&["verify", "four_bar", "--states", "0"], "at least 1"),
    ];
    for (arguments, words) in cases {
        let message = failure(mbs(arguments), 2);
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
}

#[test]
fn a_directory_that_cannot_be_made_is_named() {
    let scratch = Scratch::new("file");
    fs::create_dir_all(scratch.0.parent().expect("a directory")).expect("a directory");
    fs::write(&scratch.0, "in the way").expect("a file");
    let output = run_into(&scratch, &["run", "open_chain", "--steps", "2"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write"));
    fs::remove_file(&scratch.0).expect("the file");
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    for arguments in [&["list"][..], &["expand", "four_bar"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"))
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        // The pipe closes before the program writes, or while it does.
        drop(child.stdout.take());
        let mut message = String::new();
        let mut errors = BufReader::new(child.stderr.take().expect("piped"));
        errors.read_to_string(&mut message).expect("UTF-8");
        assert!(child.wait().expect("it ends").success(), "{message}");
        assert_eq!(message, "");
    }
}

#[test]
fn a_reader_that_leaves_still_gets_the_report() {
    let scratch = Scratch::new("pipe");
    let mut child = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"))
        .args(["run", "open_chain", "--steps", "2", "--out"])
        .arg(&scratch.0)
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    assert!(child.wait().expect("it ends").success());
    assert_eq!(scratch.text("motion.csv").lines().count(), 4);
}
