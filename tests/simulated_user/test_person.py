"""The simulated person asks, asks again when nobody answers, and thanks."""

from robustnav_msgs_py.values import ObjectInstance
from robustnav_nodes.simulated_user.person import Mood, Person, choose_target


def thing(instance: int, label: str) -> ObjectInstance:
    return ObjectInstance(instance=instance, label=label, x_m=0, y_m=0, z_m=0, yaw_rad=0, size_m=(1, 1, 1))


def test_a_whole_conversation() -> None:
    person = Person("mug", ask_again_s=10.0)
    assert person.wait(0.0) == "find the mug"
    assert person.wait(5.0) is None
    assert person.wait(10.0) == "find the mug"
    assert person.hear("I am looking for the mug.") is None
    assert person.wait(1000.0) is None
    assert person.hear("I think I see the mug; I am driving there.") is None
    assert person.hear("I found the mug: it is near x = 1.0 m.") == "thank you"
    assert person.mood is Mood.DONE
    assert person.hear("You are welcome.") is None


def test_thanks_also_when_it_was_in_vain() -> None:
    person = Person("mug", ask_again_s=10.0)
    person.wait(0.0)
    person.hear("I am looking for the mug.")
    assert person.hear("I did not find the mug: not found within 200 steps.") == "thanks for trying"


def test_an_old_answer_is_not_taken_for_one_to_this_request() -> None:
    person = Person("mug", ask_again_s=10.0)
    assert person.hear("I found the mug: it is near x = 1.0 m.") is None
    assert person.mood is Mood.WANTS


def test_the_target_is_one_of_a_kind_where_there_is_one() -> None:
    objects = [thing(1, "mug"), thing(2, "mug"), thing(3, "book"), thing(4, "plant")]
    assert {choose_target(objects, seed) for seed in range(20)} == {"book", "plant"}
    assert choose_target(objects[:2], 0) == "mug"
    assert choose_target([], 0) is None
    assert choose_target(objects, 5) == choose_target(list(reversed(objects)), 5)


def test_what_is_not_there_is_not_it() -> None:
    """A mug at (0, 0): told within a metre, and elsewhere."""
    answers = {"x = 0.5 m, y = -0.6 m": "thank you", "x = -2.0 m, y = 0.0 m": "no, that is not it"}
    for place, answer in answers.items():
        person = Person("mug", ask_again_s=10.0, objects=[thing(1, "mug"), thing(2, "book")])
        person.wait(0.0)
        person.hear("I am looking for the mug.")
        assert person.hear(f"I found the mug: it is near {place}, and I am looking at it.") == answer
        assert person.mood is Mood.DONE
