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
    module.add_class::<value::PyOwnship>()?;
    module.add_class::<value::PyObstacle>()?;
    module.add_class::<value::PyVehicle>()?;
    module.add_class::<settings::PySettings>()?;
    module.add_class::<situation::PyObstacles>()?;
    module.add_class::<situation::PyMission>()?;
    module.add_class::<airspace::PyZone>()?;
    module.add_class::<airspace::PyGround>()?;
    module.add_class::<situation::PySituation>()?;
    module.add_class::<decision::PyStage>()?;
    module.add_class::<decision::PyThreat>()?;
    module.add_class::<decision::PyCandidate>()?;
    module.add_class::<decision::PyDecision>()?;
    module.add_class::<pilot::PyVehicleModel>()?;
    module.add_class::<pilot::PyAvoider>()?;
    module.add_class::<pilot::PyPilot>()?;
    module.add_class::<simulation::PySimulation>()?;
    module.add_class::<simulation::PyRun>()?;
    module.add_class::<table::PyTable>()?;
    module.add_class::<campaign::PyCampaign>()?;
    module.add_class::<worlds::PyWorlds>()?;
    module.add_class::<worlds::PyShield>()?;
    module.add_function(wrap_pyfunction!(simulation::run, module)?)?;
    module.add_function(wrap_pyfunction!(batch::batch, module)?)?;
    module.add_function(wrap_pyfunction!(batch::oracle, module)?)?;
    module.add_function(wrap_pyfunction!(league::league, module)?)?;
    module.add_function(wrap_pyfunction!(league::_league_campaigns, module)?)?;
    module.add_function(wrap_pyfunction!(stress::stress, module)?)?;
    module.add_class::<alerts::PyMonitor>()?;
    module.add_class::<identified::PyEstimate>()?;
    module.add_class::<identified::PyIdentified>()?;
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
