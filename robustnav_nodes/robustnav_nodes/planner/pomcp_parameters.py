"""What decides a POMCP search, whatever the problem."""

from dataclasses import dataclass

from robustnav_msgs_py.parameters import parameter


# Not slotted: a class can have one base with slots only, and a node's parameters have this one besides.
@dataclass(frozen=True, kw_only=True)
class PomcpParameters:
    """Budget, UCT constant and horizon; the defaults are those of the search for an object (thesis 3.2.1.2).

    `exploration` is in units of reward: about the spread of returns under the rollout policy. Beyond
    `max_depth` steps nothing counts; the first neglected reward counts discount^max_depth.
    """

    simulations: int = parameter(1024, "pomp...: simulations for one decision", low=8, high=1_000_000)
    time_budget_s: float = parameter(
        2.0, "a decision is taken after this time with the simulations so far", unit="s", low=0.01, high=60.0
    )
    batch_simulations: int = parameter(
        128, "pomp...: simulations between two looks at the clock", low=8, high=100_000
    )
    exploration: float = parameter(1000.0, "pomp...: UCT constant, in units of reward", low=0.0, high=1e6)
    discount: float = parameter(
        0.97, "worth of a reward one step later; lookahead: where worth is discount", low=0.01, high=0.999999
    )
    max_depth: int = parameter(
        300, "pomp...: steps of one simulation, tree and rollout together", low=1, high=10_000
    )
