"""A table as its users expect it, a missing file, and a class that is no policy."""

import numpy as np
import pytest
from conftest import needed

import fga


ROWS = """encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m
1,0,300,0,0,-15,0,0,30
2,0,300,200,0,0,-10,0,30
"""


@pytest.fixture
def flown(tmp_path):
    (tmp_path / "e.csv").write_text(ROWS)
    return fga.batch(tmp_path / "e.csv")


def test_a_table_has_columns_and_a_shape(flown):
    assert flown.columns == flown.column_names
    assert flown.shape == (2, len(flown.columns))
    assert "separated" in flown and "nothing" not in flown
    assert list(flown["encounter"]) == [1, 2]
    assert flown["separated"].dtype == bool
    assert flown["min_margin_m"].dtype == np.float64
    with pytest.raises(KeyError, match="expected one of encounter, "):
        flown["nothing"]


def test_a_table_is_one_of_polars_and_of_pandas(flown):
    polars = needed("polars")
    pandas = needed("pandas")
    for other in (flown.to_polars(), flown.to_pandas()):
        assert isinstance(other, (polars.DataFrame, pandas.DataFrame))
        assert list(other.columns) == flown.columns and other.shape == flown.shape
        assert list(other["min_margin_m"]) == list(flown["min_margin_m"])


def test_a_missing_file_is_not_found(tmp_path):
    for read in (fga.run, fga.VehicleModel.read, lambda path: fga.campaign(path, tmp_path / "out")):
        with pytest.raises(FileNotFoundError, match="none.toml: cannot be read: there is no such file or folder"):
            read(tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_text("name = 1")
    with pytest.raises(ValueError, match="bad.toml"):
        fga.run(tmp_path / "bad.toml")


class Nothing:
    """No policy."""


class Many:
    """A policy of batches alone."""

    def step_all(self, flights, obstacles):
        return {}


@pytest.mark.parametrize("policy", [Nothing, Many, Many()])
def test_a_class_without_step_is_refused_at_once(policy, root, tmp_path):
    with pytest.raises(TypeError, match="step"):
        fga.run(root / "scenarios/first-flight.toml", policy=policy)
    with pytest.raises(TypeError, match="step"):
        fga.campaign(root / "campaigns/table4-dynamic.toml", tmp_path / "out", encounters=10, policies=[policy])
    assert not (tmp_path / "out").exists()
