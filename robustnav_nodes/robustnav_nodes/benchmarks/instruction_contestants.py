"""The models that `bench instruction` compares."""

from collections.abc import Sequence

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.instruction.baselines import EntityGrounding, RandomGuess
from robustnav_nodes.instruction.injection import Protocol
from robustnav_nodes.instruction.model_file import LearnedModel
from robustnav_nodes.instruction.verdict import ErrorModel

NAMES = ("random", "grounding", "surprise", "blind", "iedl", "mentions")


def contestants_of(
    learned: LearnedModel, protocol: Protocol, seed: int, wanted: Sequence[str] | None = None
) -> dict[str, ErrorModel]:
    """Judges by name, baselines first; IEDL is missing where the file does not hold it.

    Raises BadParameterError for a name that is none, or that the file does not hold.
    """
    unknown = [name for name in wanted or () if name not in NAMES]
    if unknown:
        raise BadParameterError(f"there is no model {unknown[0]!r}; there are {', '.join(NAMES)}")
    models: dict[str, ErrorModel | None] = {
        "random": RandomGuess(seed),
        "grounding": EntityGrounding(),
        "surprise": learned.surprise,
        "blind": learned.model(protocol, blind=True),
        "iedl": learned.iedl(),
        "mentions": learned.model(protocol),
    }
    if wanted and any(models[name] is None for name in wanted):
        raise BadParameterError(
            "the model file holds no iedl: train one with `robustnav train iedl --minutes 25`"
        )
    return {
        name: model for name, model in models.items() if model is not None and (not wanted or name in wanted)
    }
