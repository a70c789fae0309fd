"""What the words of instructions stand for: rooms, objects and directions with the forms that people write.

The concepts and the pairs of opposites are those of the thesis (4.1.2); the forms are the ones found in R2R.
"""

from collections.abc import Mapping
from types import MappingProxyType

from robustnav_msgs_py.errors import BadParameterError

ROOM, OBJECT, DIRECTION = "room", "object", "direction"
KINDS = (DIRECTION, OBJECT, ROOM)

ROOMS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "bedroom": ("bedroom", "master bedroom", "guest bedroom", "bed room", "bedrooms"),
        "bathroom": ("bathroom", "master bathroom", "bath room", "bathrooms"),
        "restroom": ("restroom", "washroom", "powder room", "restrooms"),
        "kitchen": ("kitchen", "kitchen area", "kitchenette", "kitchens"),
        "living room": ("living room", "living area", "livingroom", "family room", "den", "living rooms"),
        "lounge": ("lounge", "lounge area", "sitting area", "sitting room", "seating area", "lounges"),
        "dining room": ("dining room", "dining area", "dinning room", "dinning area", "dining rooms"),
        "hallway": ("hallway", "hall", "corridor", "hall way", "hallways"),
        "office": ("office", "office room", "study", "offices"),
        "entryway": ("entryway", "entry way", "foyer", "lobby", "entryways"),
        "patio": ("patio", "balcony", "porch", "deck", "terrace", "patios"),
        "laundry room": ("laundry room", "laundry", "utility room", "laundry rooms"),
        "gym": ("gym", "exercise room", "fitness room", "workout room", "gyms"),
        "closet": ("closet", "closets"),
        "archway": ("archway", "arch way", "archways"),
        "garage": ("garage", "garages"),
        "library": ("library", "libraries"),
    }
)

# The first form is the one that is put in; the second its plural.
OBJECTS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "stairs": (
            "staircase",
            "stairs",
            "stair",
            "steps",
            "stairwell",
            "stairway",
            "stair case",
            "staircases",
        ),
        "door": (
            *("door", "doors", "doorway", "doorways", "double doors", "front door"),
            *("glass door", "glass doors", "french doors"),
        ),
        "table": (
            *("table", "tables", "dining table", "round table", "coffee table", "end table"),
            *("side table", "dining tables", "coffee tables", "end tables", "side tables"),
        ),
        "chair": ("chair", "chairs", "dining chair", "dining chairs", "rocking chair"),
        "armchair": ("armchair", "armchairs", "arm chair", "arm chairs", "recliner", "recliners"),
        "couch": ("couch", "couches", "sofa", "sofas", "loveseat", "sectional"),
        "bed": ("bed", "beds"),
        "nightstand": ("nightstand", "nightstands", "night stand", "night stands", "bedside table"),
        "dresser": ("dresser", "dressers", "wardrobe", "armoire", "chest"),
        "desk": ("desk", "desks"),
        "sink": ("sink", "sinks"),
        "toilet": ("toilet", "toilets"),
        "bathtub": ("bathtub", "bathtubs", "bath tub", "tub", "tubs", "hot tub", "jacuzzi"),
        "shower": ("shower", "showers"),
        "mirror": ("mirror", "mirrors"),
        "towel": ("towel", "towels"),
        "fireplace": ("fireplace", "fireplaces", "fire place", "mantle"),
        "tv": ("tv", "tvs", "television", "televisions"),
        "piano": ("piano", "pianos"),
        "picture": (
            *("painting", "paintings", "picture", "pictures", "art", "artwork"),
            *("photo", "photos", "portrait"),
        ),
        "window": ("window", "windows"),
        "plant": ("plant", "plants", "potted plant", "potted plants", "house plant"),
        "flowers": ("flower", "flowers"),
        "vase": ("vase", "vases"),
        "statue": ("statue", "statues", "sculpture", "sculptures"),
        "lamp": ("lamp", "lamps"),
        "chandelier": ("chandelier", "chandeliers"),
        "rug": ("rug", "rugs", "carpet", "carpets", "area rug"),
        "bench": ("bench", "benches"),
        "stool": ("stool", "stools", "bar stool", "bar stools", "barstools", "barstool"),
        "ottoman": ("ottoman", "ottomans"),
        "counter": ("counter", "counters", "counter top", "countertop", "countertops"),
        "island": ("island", "islands"),
        "refrigerator": ("refrigerator", "refrigerators", "fridge"),
        "stove": ("stove", "stoves", "oven", "ovens"),
        "microwave": ("microwave", "microwaves"),
        "dishwasher": ("dishwasher", "dishwashers"),
        "cabinet": ("cabinet", "cabinets", "cupboard", "cupboards"),
        "shelf": (
            *("shelf", "shelves", "bookshelf", "bookshelves", "bookcase", "bookcases"),
            *("book case", "book shelf", "book shelves"),
        ),
        "curtain": ("curtain", "curtains"),
        "column": ("column", "columns", "pillar", "pillars"),
        "railing": ("railing", "railings", "banister", "banisters", "handrail"),
        "clock": ("clock", "clocks"),
        "washing machine": ("washing machine", "washing machines", "washer", "dryer"),
        "treadmill": ("treadmill", "treadmills", "exercise bike", "exercise bikes", "exercise machine"),
        "thermostat": ("thermostat", "thermostats"),
        "trash can": ("trash can", "trash cans", "trashcan", "garbage can"),
        "basket": ("basket", "baskets"),
        "fan": ("fan", "fans", "ceiling fan", "ceiling fans"),
    }
)

# A direction, its opposite, and the pair of the thesis that both belong to.
OPPOSITES: Mapping[str, str] = MappingProxyType(
    {
        "left": "right",
        "right": "left",
        "leftmost": "rightmost",
        "rightmost": "leftmost",
        "inside": "outside",
        "outside": "inside",
        "into": "out of",
        "out of": "into",
        "forward": "backward",
        "backward": "forward",
        "forwards": "backwards",
        "backwards": "forwards",
        "down": "up",
        "up": "down",
        "around": "back",
        "back": "around",
    }
)
PAIRS: Mapping[str, str] = MappingProxyType(
    {
        "left": "left/right",
        "leftmost": "leftmost/rightmost",
        "inside": "inside/outside",
        "into": "into/out of",
        "forward": "forward/backward",
        "forwards": "forward/backward",
        "down": "go down/go up",
        "around": "go around/go back",
    }
)
# "up", "down", "around" and "back" are directions of a walk only after one of these.
GOING = frozenset(
    {
        *("go", "goes", "going", "walk", "walks", "walking", "continue", "continuing", "head", "heading"),
        *("proceed", "proceeding", "move", "moving", "travel", "climb", "climbing", "run", "step", "come"),
    }
)
AFTER_GOING = frozenset({"up", "down", "around", "back"})

# Room types of the evidence that a room word may stand for.
ROOM_TYPES_OF: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "bedroom": ("bedroom",),
        "bathroom": ("bathroom",),
        "restroom": ("bathroom",),
        "kitchen": ("kitchen",),
        "living room": ("livingroom", "familyroom"),
        "lounge": ("lounge", "livingroom", "familyroom"),
        "dining room": ("diningroom",),
        "hallway": ("hallway",),
        "office": ("office",),
        "entryway": ("entryway",),
        "patio": ("porch",),
    }
)


# Doors are nearly everywhere and listed now and then: whether one was there cannot be looked up.
HARDLY_LISTED = frozenset({"door"})


def pair_of(direction: str) -> str:
    """The pair of opposites that a direction belongs to: "left/right" of "right".

    Raises BadParameterError for a word that is no direction.
    """
    if direction not in OPPOSITES:
        raise BadParameterError(f"{direction!r} is no direction; there are {', '.join(OPPOSITES)}")
    return PAIRS[direction] if direction in PAIRS else PAIRS[OPPOSITES[direction]]


def is_plural(form: str) -> bool:
    """Whether a form names several things; good for the forms of this file."""
    word = form.split()[-1]
    return word.endswith("s") and not word.endswith("ss")


def put_in_form(kind: str, concept: str, *, plural: bool) -> str:
    """The form that stands for a concept where it replaces another one."""
    if kind == DIRECTION:
        return concept
    if kind == OBJECT:
        return OBJECTS[concept][1 if plural else 0]
    return ROOMS[concept][-1] if plural else concept


# Every concept has a number: directions first, then objects, then rooms.
CONCEPTS: tuple[tuple[str, str], ...] = (
    *((DIRECTION, concept) for concept in OPPOSITES),
    *((OBJECT, concept) for concept in OBJECTS),
    *((ROOM, concept) for concept in ROOMS),
)
CONCEPT_NUMBER: Mapping[tuple[str, str], int] = MappingProxyType({key: k for k, key in enumerate(CONCEPTS)})
FIRST_OBJECT = len(OPPOSITES)
FIRST_ROOM = len(OPPOSITES) + len(OBJECTS)
