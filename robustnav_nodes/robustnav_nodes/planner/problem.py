"""What POMCP must know of a problem: how it begins, what is legal, what a step does, and its sizes.

The solver calls the functions below; numba takes the implementation by the type of the model, as Julia would,
so that one solver serves every problem and a step costs what it would cost inline. A problem is a NamedTuple
and at least a `step`. The tiger problem (Kaelbling et al. 1998), whole:

>>> from typing import NamedTuple
>>> import numpy as np
>>> from robustnav_nodes.planner.particle_update import updated_particles
>>> from robustnav_nodes.planner.pomcp import plan
>>> from robustnav_nodes.planner.pomcp_parameters import PomcpParameters
>>> from robustnav_nodes.planner.problem import Problem, implement
>>> from robustnav_nodes.planner.random_stream import below, uniform

>>> class Tiger(NamedTuple):
...     p_hears_right: float
>>> def step(model, state, action, rng):  # state: [door of the tiger]; 0, 1: open that door; 2: listen
...     if action == 2:
...         heard = state[0] if uniform(rng) < model.p_hears_right else 1 - state[0]
...         return heard, -1.0, False
...     reward = -100.0 if action == state[0] else 10.0
...     state[0] = below(rng, 2)
...     return 0, reward, False
>>> def rollout_step(model, state, actions, rng):  # listen for ever; by default any legal action
...     return -1.0, False
>>> implement(Tiger, step=step, rollout_step=rollout_step)
>>> tiger = Problem(actions=3, observations=2, state_size=1)

>>> model, rng = Tiger(p_hears_right=0.85), np.random.default_rng(1)
>>> parameters = PomcpParameters(simulations=4096, exploration=100.0, discount=0.95, max_depth=90)
>>> particles = rng.integers(2, size=(4096, 1))
>>> plan(tiger, model, particles, parameters, rng).action  # nobody knows where the tiger is: listen
2
>>> for _ in range(3):  # it is heard on the left three times
...     particles = updated_particles(tiger, model, particles, action=2, observation=0, rng=rng).particles
>>> plan(tiger, model, particles, parameters, rng).action
1

numba keeps compiled code on disk only under the file of a function that is compiled for one problem. So that
it need not compile in every new process, a problem in a file binds itself to the solver:

    @compiled
    def _simulate_tiger(model, tree, particles, first, last, rng):
        simulate(model, tree, particles, first, last, rng)

    tiger = Problem(actions=3, observations=2, state_size=1, simulate=_simulate_tiger)
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from robustnav_nodes.planner.random_stream import Stream, below

Particles = NDArray[np.int64]  # [p], or [p, w]; what one says is the problem's own business
State = NDArray[np.int64]  # [state_size]

_implementations: dict[type, dict[str, Callable[..., Any]]] = {}


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A POMDP's numbers of actions and observations, and the length of its state.

    simulate: `pomcp.simulate` bound to one type of model, to be kept on disk; None: any model, compiled in
    each process anew.
    """

    actions: int
    observations: int
    state_size: int
    simulate: Callable[..., None] | None = None


def implement(
    model_type: type,
    *,
    step: Callable[..., Any],
    begin: Callable[..., Any] | None = None,
    is_legal: Callable[..., Any] | None = None,
    rollout_step: Callable[..., Any] | None = None,
    prior: Callable[..., Any] | None = None,
    reinvigorate: Callable[..., Any] | None = None,
) -> None:
    """Register the functions of a problem, plain Python that numba can compile, for its type of model.

    Each has the arguments and the meaning of the function of its name below; what is left out has a default,
    which costs nothing. Chance comes from `random_stream` alone, with the `rng` that a function is given.
    """
    given = {
        "step": step,
        "begin": begin,
        "is_legal": is_legal,
        "rollout_step": rollout_step,
        "prior": prior,
        "reinvigorate": reinvigorate,
    }
    _implementations[model_type] = {
        name: function for name, function in given.items() if function is not None
    }


def step(model: Any, state: State, action: int, rng: Stream) -> tuple[int, float, bool]:
    """Take a legal action: changes `state`; gives observation, reward, and whether the problem ends."""
    raise NotImplementedError


def begin(model: Any, particle: Any, simulation: int, state: State) -> None:
    """Write the state in which a simulation begins; by default the particle is the whole state.

    particle: int64, or int64 [w], as `plan` was given them; simulation: its number, ascending from 0 in each
    decision.
    """
    raise NotImplementedError


def is_legal(model: Any, state: State, action: int) -> bool:
    """Whether `action` can be taken in `state`; by default every action can.

    Must not depend on what is hidden, or the search would learn it from what is legal.
    """
    raise NotImplementedError


def rollout_step(model: Any, state: State, actions: int, rng: Stream) -> tuple[float, bool]:
    """Take one step beyond the tree: changes `state`; gives reward and whether the rollout ends.

    By default one of the legal ones of `actions` actions, uniformly; ends where none is legal. A problem that
    prefers some actions (Silver and Veness 2010, section 5) takes one of those here. What its preference
    needs of the history it keeps in the state.
    """
    raise NotImplementedError


def prior(model: Any, state: State, action: int) -> tuple[int, float]:
    """Visits and mean return with which an action begins in a new node of the tree; by default 0, 0.0.

    Preferred actions begin with some of each (N_init and V_init in Silver and Veness 2010). May depend on
    what is known in `state`, not on what is hidden: the node belongs to every state with its history.
    """
    raise NotImplementedError


def reinvigorate(model: Any, state: State, rng: Stream) -> None:
    """Change what is hidden in `state` to something else that its history allows; by default nothing.

    Keeps the particles of several decisions from becoming copies of a few. A change that leaves the
    posterior as it is, such as drawing one hidden variable anew given all else, keeps the update exact.
    """
    raise NotImplementedError


def _every_action_is_legal(model: Any, state: State, action: int) -> bool:
    return True


def _particle_is_state(model: Any, particle: Any, simulation: int, state: State) -> None:
    state[:] = particle


def _uniform_rollout_step(model: Any, state: State, actions: int, rng: Stream) -> tuple[float, bool]:
    legal = 0
    for action in range(actions):
        if is_legal(model, state, action):
            legal += 1
    if legal == 0:
        return 0.0, True
    left = below(rng, legal)
    chosen = 0
    for action in range(actions):
        if is_legal(model, state, action):
            if left == 0:
                chosen = action
                break
            left -= 1
    _, reward, ended = step(model, state, chosen, rng)
    return reward, ended


def _no_prior(model: Any, state: State, action: int) -> tuple[int, float]:
    return 0, 0.0


def _leave(model: Any, state: State, rng: Stream) -> None:
    pass


def _implementation(
    model: Any, name: str, default: Callable[..., Any] | None = None
) -> Callable[..., Any] | None:
    is_model = isinstance(model, types.BaseNamedTuple) and model.instance_class in _implementations
    return _implementations[model.instance_class].get(name, default) if is_model else None


# Not strict: implementations carry annotations of their own, which numba would compare with these.
@overload(step, strict=False)
def _step(model: Any, state: Any, action: Any, rng: Any) -> Any:
    return _implementation(model, "step")


@overload(begin, strict=False)
def _begin(model: Any, particle: Any, simulation: Any, state: Any) -> Any:
    return _implementation(model, "begin", _particle_is_state)


@overload(is_legal, strict=False)
def _is_legal(model: Any, state: Any, action: Any) -> Any:
    return _implementation(model, "is_legal", _every_action_is_legal)


@overload(rollout_step, strict=False)
def _rollout_step(model: Any, state: Any, actions: Any, rng: Any) -> Any:
    return _implementation(model, "rollout_step", _uniform_rollout_step)


@overload(prior, strict=False)
def _prior(model: Any, state: Any, action: Any) -> Any:
    return _implementation(model, "prior", _no_prior)


@overload(reinvigorate, strict=False)
def _reinvigorate(model: Any, state: Any, rng: Any) -> Any:
    return _implementation(model, "reinvigorate", _leave)
