"""The models that `bench instruction` compares."""

from collections.abc import Callable, Sequence
from importlib.util import find_spec

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.instruction.baselines import EntityGrounding, RandomGuess
from robustnav_nodes.instruction.injection import Protocol
from robustnav_nodes.instruction.model_file import LearnedModel
from robustnav_nodes.instruction.panorama import PanoramicEncoder
from robustnav_nodes.instruction.verdict import ErrorModel

NAMES = ("random", "grounding", "surprise", "blind", "iedl", "mentions")


def contestants_of(
    learned: LearnedModel,
    protocol: Protocol,
    seed: int,
    wanted: Sequence[str] | None = None,
    encoder: PanoramicEncoder | None = None,
) -> dict[str, ErrorModel]:
    """Judges by name, baselines first; IEDL is missing where the file does not hold it, and without torch.

    `encoder` is IEDL's (None: the semantic one). Raises BadParameterError for a name that is none, or that
    the file does not hold, BadFileError where IEDL was trained with another encoder.
    """
    unknown = [name for name in wanted or () if name not in NAMES]
    if unknown:
        raise BadParameterError(f"there is no model {unknown[0]!r}; there are {', '.join(NAMES)}")
    makers: dict[str, Callable[[], ErrorModel | None]] = {
        "random": lambda: RandomGuess(seed),
        "grounding": EntityGrounding,
        "surprise": lambda: learned.surprise,
        "blind": lambda: learned.model(protocol, blind=True),
        "iedl": lambda: learned.iedl(encoder) if _has_torch() else None,
        "mentions": lambda: learned.model(protocol),
    }
    found: dict[str, ErrorModel] = {}
    for name in NAMES:
        model = makers[name]() if not wanted or name in wanted else None
        if model is not None:
            found[name] = model
        elif wanted and name in wanted:
            raise BadParameterError(
                "iedl cannot be judged: it needs torch (pip install 'robustnav[learn]') and a model file "
                "that holds it (`robustnav train iedl`)"
            )
    return found


def _has_torch() -> bool:
    return find_spec("torch") is not None
