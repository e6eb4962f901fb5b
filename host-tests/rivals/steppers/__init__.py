"""Other people's tools on the problem of desktop/oracle, a file each.

Each file has `rivals(shell)`, which yields a `Rival` a precision; one is done with before the next is asked for.
"""

import typing

# Steps that are recorded, or done between two calls from Python; divides 1000.
BATCH = 100


class Rival(typing.NamedTuple):
    """A shell in motion, from its start."""

    name: str
    precision: str
    # Advances by a multiple of BATCH steps.
    run: typing.Callable[[int], None]
    # Where the nodes are (m), a row a node.
    positions: typing.Callable
