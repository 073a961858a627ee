//! fga for Python: translates, and decides nothing.
//!
//! | module | question |
//! |---|---|
//! | [`mod@value`], [`situation`], [`airspace`] | what is the input of a decision? |
//! | [`decision`] | what is a decision? |
//! | [`pilot`] | who decides? |
//! | [`own`] | how does a policy of one's own decide? |
//! | [`together`] | how does one decide for many flights at once? |
//! | [`simulation`] | what is the result of one flight? |
//! | [`batch`], [`campaign`] | what is the result of many? |
//! | [`league`] | how do policies compare? |
//! | [`stress`] | in which motions does a policy fail? |
//! | [`worlds`] | what do policies that learn see, and what keeps them safe? |
//! | [`alerts`] | what do the standards say of it? |
//! | [`identified`] | which aircraft does a flight log show? |
//! | [`table`] | how do tables come in and go out? |
//! | [`work`] | how does Ctrl-C end long work? |
//! | [`failure`] | which exception does an error become? |

#![deny(unsafe_code)]

mod airspace;
mod alerts;
mod batch;
mod campaign;
mod decision;
mod failure;
mod identified;
mod league;
mod own;
mod pilot;
mod settings;
mod simulation;
mod situation;
mod stress;
mod table;
mod together;
mod value;
mod work;
mod worlds;

use pyo3::prelude::*;

/// The compiled part of the package `fga`.
#[pymodule]
fn _fga(module: &Bound<'_, PyModule>) -> PyResult<()> {
    fga_formats::build::set_commit(fga_build::COMMIT);
    module.add_class::<value::Ownship>()?;
    module.add_class::<value::Obstacle>()?;
    module.add_class::<value::Vehicle>()?;
    module.add_class::<settings::Settings>()?;
    module.add_class::<situation::Obstacles>()?;
    module.add_class::<situation::Mission>()?;
    module.add_class::<airspace::Zone>()?;
    module.add_class::<airspace::Ground>()?;
    module.add_class::<situation::Situation>()?;
    module.add_class::<decision::Stage>()?;
    module.add_class::<decision::Threat>()?;
    module.add_class::<decision::Candidate>()?;
    module.add_class::<decision::Decision>()?;
    module.add_class::<pilot::VehicleModel>()?;
    module.add_class::<pilot::Avoider>()?;
    module.add_class::<pilot::Pilot>()?;
    module.add_class::<simulation::Simulation>()?;
    module.add_class::<simulation::Run>()?;
    module.add_class::<table::Table>()?;
    module.add_class::<campaign::Campaign>()?;
    module.add_class::<worlds::Worlds>()?;
    module.add_class::<worlds::Shield>()?;
    module.add_function(wrap_pyfunction!(simulation::run, module)?)?;
    module.add_function(wrap_pyfunction!(batch::batch, module)?)?;
    module.add_function(wrap_pyfunction!(batch::oracle, module)?)?;
    module.add_function(wrap_pyfunction!(league::league, module)?)?;
    module.add_function(wrap_pyfunction!(league::_league_campaigns, module)?)?;
    module.add_function(wrap_pyfunction!(stress::stress, module)?)?;
    module.add_class::<alerts::Monitor>()?;
    module.add_class::<identified::Estimate>()?;
    module.add_class::<identified::Identified>()?;
    module.add_function(wrap_pyfunction!(alerts::alerts, module)?)?;
    module.add_function(wrap_pyfunction!(alerts::bands, module)?)?;
    module.add_function(wrap_pyfunction!(identified::identify, module)?)?;
    // What pickles name.
    module.add_function(wrap_pyfunction!(decision::_threat, module)?)?;
    module.add_function(wrap_pyfunction!(decision::_candidate, module)?)?;
    module.add_function(wrap_pyfunction!(decision::_decision, module)?)?;
    module.add_function(wrap_pyfunction!(identified::_estimate, module)?)?;
    module.add_function(wrap_pyfunction!(identified::_identified, module)?)?;
    module.add("versions", campaign::versions(module.py())?)?;
    Ok(())
}
