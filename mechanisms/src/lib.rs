//! Ready mechanisms, a file each: its text with title, presets and picture, and tests against a closed form or a reference solution.
//!
//! [`CATALOGUE`] lists them; a new one is a file, its `mod` and its line there. The program `mbs-catalogue` runs, draws, prints and
//! checks them.
//!
//! ```
//! let card = mechanisms::CATALOGUE.find("four_bar").expect("in the list");
//! let runs = card.runs().expect("presets of the text");
//! let mechanism = card.fixed_instance(&runs[0]).expect("parameters of the preset");
//! let motion = mbs_workbench::catalogue::sweep(mechanism.as_ref(), 1.0, 100).expect("it turns fully");
//! assert!(motion.closure.iter().all(|error| *error < 1e-12));
//! ```

pub mod andrews;
pub mod bouncing_balls;
pub mod bricard;
pub mod cam_flat;
pub mod cam_law;
pub mod cam_oscillating;
pub mod cam_roller;
pub mod car_axis;
pub mod cart_pole;
pub mod desmo;
pub mod determinant_guide;
pub mod door_with_closer;
pub mod double_parallelogram;
pub mod double_pendulum;
pub mod elliptic;
pub mod five_angle_loop;
pub mod four_bar;
pub mod four_bar_mass;
pub mod four_bar_mixed;
pub mod four_bar_natural;
pub mod four_bar_reference_point;
pub mod geneva;
pub mod governor;
pub mod heavy_top;
pub mod jansen;
pub mod kerb;
pub mod known;
pub mod loop_length;
pub mod loop_relative;
pub mod n_four_bar;
pub mod n_four_bar_1;
pub mod n_four_bar_10;
pub mod n_four_bar_40;
pub mod open_chain;
pub mod peaucellier;
pub mod pendulum;
pub mod planetary_gear;
pub mod quarter_car;
pub mod quick_return;
pub mod scotch_yoke;
pub mod slider_crank;
pub mod slider_crank_engine;
pub mod slider_crank_mass;
pub mod slider_crank_scenes;
pub mod stephenson;
pub mod three_rrr;
pub mod valve_spring;
pub mod watt;
pub mod woodpecker;

use mbs_workbench::catalogue::Catalogue;

/// Every ready mechanism.
pub static CATALOGUE: Catalogue = Catalogue {
    cards: &[
        four_bar::CARD,
        loop_relative::CARD,
        loop_length::CARD,
        open_chain::CARD,
        slider_crank::CARD,
        five_angle_loop::CARD,
        four_bar_reference_point::CARD,
        four_bar_natural::CARD,
        four_bar_mixed::CARD,
        determinant_guide::CARD,
        quick_return::CARD,
        scotch_yoke::CARD,
        geneva::CARD,
        watt::CARD,
        stephenson::CARD,
        jansen::CARD,
        peaucellier::CARD,
        three_rrr::CARD,
        cam_flat::CARD,
        cam_roller::CARD,
        cam_oscillating::CARD,
        cam_law::CARD,
        desmo::CARD,
        planetary_gear::CARD,
        double_parallelogram::CARD,
        slider_crank_scenes::DRIVEN_CRANK,
        slider_crank_scenes::DRIVEN_SLIDER,
        slider_crank_scenes::TELESCOPING_ROD,
        slider_crank_mass::DRIVEN,
        four_bar_mass::DRIVEN,
        pendulum::CARD,
        double_pendulum::CARD,
        cart_pole::CARD,
        n_four_bar_1::CARD,
        n_four_bar::CARD,
        n_four_bar_10::CARD,
        n_four_bar_40::CARD,
        andrews::CARD,
        heavy_top::CARD,
        car_axis::CARD,
        quarter_car::CARD,
        kerb::CARD,
        bricard::CARD,
        governor::CARD,
        slider_crank_engine::CARD,
        bouncing_balls::CARD,
        valve_spring::CARD,
        door_with_closer::CARD,
        woodpecker::CARD,
        slider_crank_mass::RELEASED,
        four_bar_mass::RELEASED,
    ],
};
