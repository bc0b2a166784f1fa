"""The board of a ranking: which items are placed, and in which order. Pure; nothing is ever changed in place."""

from dataclasses import dataclass, replace

__all__ = ["RankingBoard"]


@dataclass(frozen=True)
class RankingBoard:
    """Items to arrange, and those arranged so far.

    Attributes
    ----------
    items
        All of them, in the order in which they lie at the start.
    placed
        Those placed, the lowest rank first. They stand without gaps: the next free place is that after the last.

    Examples
    --------
    >>> board = RankingBoard(("a", "b", "c")).place("b", 0).place("a", 0).place("c", 9)
    >>> board.placed, board.complete
    (('a', 'b', 'c'), True)
    """

    items: tuple[str, ...]
    placed: tuple[str, ...] = ()

    @property
    def complete(self) -> bool:
        """Whether every item has a rank."""
        return len(self.placed) == len(self.items)

    @property
    def waiting(self) -> tuple[str, ...]:
        """The items without a rank, in the order in which they lie."""
        return tuple(item for item in self.items if item not in self.placed)

    def place(self, item: str, index: int) -> "RankingBoard":
        """Put `item` at place `index`, from 0; those from there on move up. Beyond the last place it comes last."""
        others = [name for name in self.placed if name != item]
        others.insert(max(0, index), item)
        return replace(self, placed=tuple(others))

    def take_back(self, item: str) -> "RankingBoard":
        """Take `item` out of the order again."""
        return replace(self, placed=tuple(name for name in self.placed if name != item))

    def move(self, item: str, step: int) -> "RankingBoard":
        """Move a placed `item` by `step` places, no further than the ends; an item without a rank stays."""
        if item not in self.placed:
            return self
        index = self.placed.index(item) + step
        return self.place(item, min(max(index, 0), len(self.placed) - 1))
