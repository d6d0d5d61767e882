"""gust's random numbers: named streams on the counter-based generator Philox4x32-10 (Salmon et al. 2011)."""

import numpy as np

LOW, EVERY_BIT = 2**32 - 1, 2**64 - 1
DRAW, SPLIT = 0, 1  # what a counter is used for


def philox(key, counter, purpose):
    """The two 64-bit words of a counter's block; of every one's if it is an array."""
    if not isinstance(counter, int):
        counter = np.asarray(counter, dtype=np.uint64)
    words = [counter & LOW, counter >> 32, purpose, 0]
    keys = [key & LOW, key >> 32]
    for _ in range(10):
        first, second = 0xd2511f53 * words[0], 0xcd9e8d57 * words[2]
        words = [second >> 32 ^ words[1] ^ keys[0], second & LOW, first >> 32 ^ words[3] ^ keys[1], first & LOW]
        keys = [keys[0] + 0x9e3779b9 & LOW, keys[1] + 0xbb67ae85 & LOW]
    return words[0] | words[1] << 32, words[2] | words[3] << 32


def unit(bits):
    """The upper 53 bits as a number in [0, 1)."""
    return (bits >> 11) * 2.0**-53


class Rng:
    """A stream; number i of it depends on its seed and path alone. A whole array of numbers i gives an array."""

    def __init__(self, seed, key=None):
        self.key = philox(seed, 0x6775737400000000, SPLIT)[0] if key is None else key

    def split(self, which):
        """The stream of a child: of a number, or of a purpose by its name."""
        if not isinstance(which, str):
            return Rng(None, philox(self.key, int(which), SPLIT)[0])
        tag = 0xcbf29ce484222325  # FNV-1a
        for letter in which.encode():
            tag = (tag ^ letter) * 0x100000001b3 & EVERY_BIT
        return Rng(None, philox(self.key ^ EVERY_BIT, tag, SPLIT)[0])

    def uniform(self, i):
        return unit(philox(self.key, i, DRAW)[0])

    def normal(self, i):
        """By Box and Muller."""
        first, second = map(unit, philox(self.key, i, DRAW))
        return np.sqrt(-2 * np.log(1 - first)) * np.cos(2 * np.pi * second)

    def below(self, n, i):
        """Whole numbers in 0 ... n-1 for n < 2^32: the upper half of the product of 128 bits."""
        bits = philox(self.key, i, DRAW)[0]
        return (bits >> 32) * n + ((bits & LOW) * n >> 32) >> 32

    def permutation(self, count):
        """By Fisher and Yates from behind: the last of i places changes with place below(i), which is draw i."""
        order = np.arange(count)
        sizes = np.arange(count, 1, -1, dtype=np.uint64)
        for size, other in zip(sizes.tolist(), self.below(sizes, sizes).tolist()):
            order[size - 1], order[other] = order[other], order[size - 1]
        return order
