"""What is kept of what was made."""

from concurrent.futures import ThreadPoolExecutor

from gearsim.metrology.kept import Kept


def test_a_thing_is_made_once_until_others_push_it_out():
    made: list[int] = []
    kept: Kept[str] = Kept(2)

    def get(key: int) -> str:
        def make() -> str:
            made.append(key)
            return str(key)

        return kept.get(key, make)

    assert [get(k) for k in (1, 1, 2, 2, 1)] == ["1", "1", "2", "2", "1"]
    assert made == [1, 2]
    assert get(3) == "3"
    assert get(2) == "2"  # still kept beside the third
    assert get(1) == "1"
    assert made == [1, 2, 3, 1]


def test_threads_that_make_the_same_get_one_thing_and_leave_no_more_than_is_kept():
    kept: Kept[object] = Kept(1)
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda k: kept.get(k % 3, object), range(300)))
    assert len(found) == 300
    assert len(kept._made) == 1
    one = kept.get("same", object)
    assert kept.get("same", object) is one
