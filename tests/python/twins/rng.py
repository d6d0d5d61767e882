"""gust's random numbers: named streams on the counter-based generator Philox4x32-10 (Salmon et al. 2011)."""

import numpy as np

LOW = np.uint64(0xffffffff)
HALF = np.uint64(32)
EVERY_BIT = 2**64 - 1
DRAW, SPLIT = 0, 1  # what a counter is used for


def philox(key, counters, purpose):
    """The two 64-bit words of each counter's block."""
    counters = np.asarray(counters, dtype=np.uint64)
    words = [counters & LOW, counters >> HALF, np.full_like(counters, purpose), np.zeros_like(counters)]
    keys = [key & 0xffffffff, key >> 32]
    for _ in range(10):
        first, second = np.uint64(0xd2511f53) * words[0], np.uint64(0xcd9e8d57) * words[2]
        words = [second >> HALF ^ words[1] ^ np.uint64(keys[0]), second & LOW,
                 first >> HALF ^ words[3] ^ np.uint64(keys[1]), first & LOW]
        keys = [(keys[0] + 0x9e3779b9) & 0xffffffff, (keys[1] + 0xbb67ae85) & 0xffffffff]
    return words[0] | words[1] << HALF, words[2] | words[3] << HALF


def unit(bits):
    """The upper 53 bits as a number in [0, 1)."""
    return (bits >> np.uint64(11)) * 2.0**-53


class Rng:
    """A stream; number i of it depends on its seed and path alone."""

    def __init__(self, seed, key=None):
        self.key = self.mixed(seed, 0x6775737400000000) if key is None else key

    @staticmethod
    def mixed(key, tag):
        return int(philox(key, [tag], SPLIT)[0][0])

    def split(self, which):
        """The stream of a child: of a number, or of a purpose by its name."""
        if isinstance(which, str):
            tag = 0xcbf29ce484222325  # FNV-1a
            for letter in which.encode():
                tag = (tag ^ letter) * 0x100000001b3 & EVERY_BIT
            return Rng(0, self.mixed(self.key ^ EVERY_BIT, tag))
        return Rng(0, self.mixed(self.key, which))

    def uniform(self, i):
        return unit(philox(self.key, i, DRAW)[0])

    def normal(self, i):
        """By Box and Muller."""
        first, second = map(unit, philox(self.key, i, DRAW))
        return np.sqrt(-2 * np.log(1 - first)) * np.cos(2 * np.pi * second)

    def below(self, n, i):
        """Whole numbers in 0 ... n-1; n < 2^32: the upper half of the 128-bit product."""
        bits, n = philox(self.key, i, DRAW)[0], np.asarray(n, dtype=np.uint64)
        return ((bits >> HALF) * n + ((bits & LOW) * n >> HALF) >> HALF).astype(int)

    def permutation(self, count):
        """By Fisher and Yates from behind: place i changes with place below(i + 1), draw number i + 1."""
        order = np.arange(count)
        sizes = np.arange(count, 1, -1)
        for size, other in zip(sizes, self.below(sizes, sizes)):
            order[size - 1], order[other] = order[other], order[size - 1]
        return order
