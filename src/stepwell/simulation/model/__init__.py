"""A robot as a MuJoCo model."""

from stepwell.simulation.model.model import HEIGHT, mjcf, spec
from stepwell.simulation.model.sensors import columns, contacts, obstacle_names, rod_names, sampled
from stepwell.simulation.model.settings import Integrator, Linkage, Settings
from stepwell.simulation.model.simulator import Model, mujoco, quietly, rollout
