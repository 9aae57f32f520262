from nxt_twin.blind.spread import CaseTask, spread
from nxt_twin.fleet.workers.place import Here, Processes


def ended(name, why):
    return name, why


def broken(_name):
    raise ValueError("not this one")


def test_each_case_ends_with_its_name_and_one_that_raises_fails_alone():
    tasks = [
        CaseTask("good", ended, ("good", "")),
        CaseTask("refused", ended, ("refused", "is empty")),
        CaseTask("broken", broken, ("broken",)),
    ]
    expected = {"good": "", "refused": "is empty", "broken": "broken: ValueError: not this one"}
    assert dict(spread(tasks, Here())) == expected
    assert dict(spread(tasks, Processes(1))) == expected
