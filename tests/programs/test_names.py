"""Operations of one program go by names of their own."""

import pytest

from gearsim.programs.names import distinct


@pytest.mark.parametrize(
    ("given", "own"),
    [
        ((), ()),
        (("a", "b"), ("a", "b")),
        (("a", "a", "a"), ("a", "a (2)", "a (3)")),
        (("a", "a", "a (2)", "a"), ("a", "a (3)", "a (2)", "a (4)")),
        (("a (2)", "a", "a (2)", "a"), ("a (2)", "a", "a (2) (2)", "a (3)")),
    ],
)
def test_a_name_given_before_is_numbered(given, own):
    assert distinct(given) == own
    assert len(set(own)) == len(own)
