"""A node's health: problems are logged once, shown for a while, and kept count of."""

from robustnav_msgs_py.values import ERROR, OK, WARN
from robustnav_nodes.graph.health import FORGET_S, REMEMBER_S, Health


class Clock:
    now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def test_a_problem_is_logged_once_and_counted() -> None:
    log: list[tuple[int, str]] = []
    clock = Clock()
    health = Health(lambda level, sentence: log.append((level, sentence)), clock)
    for tick in range(50):
        health.problem("map", f"bad cell {tick}")
    assert log == [(WARN, "map: bad cell 0")]
    assert health.status("n", []).values["problem map"] == "bad cell 49 (50 times)"
    clock.now_s += REMEMBER_S + 1.0
    health.problem("map", "another trouble", ERROR, detail=" in detail")
    assert log[1:] == [(ERROR, "map: another trouble in detail")]


def test_the_worst_recent_problem_is_the_message_until_it_is_over() -> None:
    clock = Clock()
    health = Health(lambda level, sentence: None, clock)
    health.problem("a", "bad", ERROR)
    health.problem("b", "odd")
    assert (health.status("n", []).level, health.status("n", []).message) == (ERROR, "bad")
    clock.now_s += REMEMBER_S + 1.0
    health.problem("b", "odd")
    assert (health.status("n", []).level, health.status("n", []).message) == (WARN, "odd")
    clock.now_s += REMEMBER_S + 1.0
    assert (health.status("n", []).level, health.status("n", []).message) == (OK, "ok")


def test_another_trouble_at_the_same_place_is_logged_when_its_time_has_come() -> None:
    log: list[tuple[int, str]] = []
    clock = Clock()
    health = Health(lambda level, sentence: log.append((level, sentence)), clock)
    health.problem("map", "first")
    for _ in range(int(REMEMBER_S) + 2):
        clock.now_s += 1.0
        health.problem("map", "second")
    assert [sentence for _, sentence in log] == ["map: first", "map: second"]
    clock.now_s += FORGET_S + 1.0
    health.problem("map", "second")
    assert len(log) == 3


def test_figures_and_waiting() -> None:
    health = Health(lambda level, sentence: None)
    health.figure("rate", 3.14159265)
    health.count("images")
    health.count("images", 2)
    status = health.status("n", ["map", "odom"])
    assert status.values == {"rate": "3.142", "images": "3"}
    assert (status.level, status.message) == (OK, "waiting for map, odom")
