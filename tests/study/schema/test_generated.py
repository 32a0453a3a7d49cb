"""Sections that follow from the model: what a study file can set is what the model has."""

import dataclasses

import pytest

import granstudy as gs
from granstudy.model import densities
from granstudy.study.schema.generated import density_fields, in_yaml, solver_fields
from granstudy.study.schema.sections import SceneModel, SolverModel


def test_the_solver_section_has_every_field_of_a_solver_but_threads():
    fields = {field.name for field in dataclasses.fields(gs.Solver)}
    assert set(SolverModel.model_fields) == fields - {"threads"}
    for name, field in SolverModel.model_fields.items():
        assert field.default is None and field.description, name
    section = SolverModel(N=8, M_sph=[2, 3], rtol=1)
    assert section.model_dump(exclude_none=True) == {"N": 8, "M_sph": [2, 3], "rtol": 1}


def test_types_are_those_that_yaml_writes():
    assert in_yaml(tuple[float, ...]) == list[float]
    assert in_yaml(int | tuple[int, int] | None) == int | list[int] | None
    assert in_yaml(str) is str


def test_the_scene_section_has_the_parameters_of_all_densities():
    scene = SceneModel(name="maxwellian2d", velocity=[0.5, 0.0], temperature=2)
    assert scene.words == {"velocity": [0.5, 0.0], "temperature": 2}
    assert set(density_fields()) == {"temperature", "velocity", "separation", "tail"}
    help_text = SceneModel.model_fields["temperature"].description
    assert help_text == (
        "maxwellian, uniform_ball, power_law: temperature T, default 1; "
        "two_beams: temperature T of each beam, default 1"
    )


def test_a_new_density_brings_its_parameters_along(monkeypatch):
    @dataclasses.dataclass(frozen=True)
    class Ring:
        dim = 2
        width: float = densities.parameter(1.0, "width of the ring")

    monkeypatch.setitem(densities.INITIAL_DENSITIES, "ring2d", Ring)
    kind, default = density_fields()["width"]
    assert default is None and kind.__metadata__[0].description == "ring: width of the ring"
    assert "width" not in SceneModel.model_fields
    assert solver_fields().keys() == SolverModel.model_fields.keys()
    with pytest.raises(ValueError, match="width"):
        gs.load_scene("bkw2d", width=2.0)
