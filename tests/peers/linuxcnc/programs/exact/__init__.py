"""Programs at the edges of the language, written by hand; those without % get an M2 at the end; numbered."""

from tests.peers.linuxcnc.programs.exact.layout import LAYOUT
from tests.peers.linuxcnc.programs.exact.o_words import O_WORDS
from tests.peers.linuxcnc.programs.exact.spelling import SPELLING
from tests.peers.linuxcnc.programs.exact.values import VALUES

EXACT = [*VALUES, *LAYOUT, *O_WORDS, *SPELLING]
