"""Texts, changed in their bytes, words, numbers, lines or parts, as files are damaged or made by an attacker."""

import random
import re
from collections.abc import Callable

# Words that are put in the place of others.
STRAY_WORDS = (
    "2147483648", "-2147483648", "65536*65536", "X*X", "C+1", "not ", "-object(o1)", "#count{X : object(X)}", "1..",
    "#sum{C,X : shape(X,_,C)}", "banana", "_", "choose(1)", "#true", "@f(1)", "&diff{a}", "|", "**", "#inf", "{", "}",
    '"', "'", "(", ")", "((", "))", ".", "..", ",", ";", ":-", "%", "%*", "*%", "#include", '#include "/etc/passwd".',
    "#script (python)", "#const n=1.", "@f()", "X", "_", "-", "--1", "99999999999999999999", "-2147483649", "1e999",
    "nan", "inf", "1.5", "0x10", "\\", "\x00", "\x1b[31m", "\r", "\t", "\ufeff", "\u201c", "\u201d", "\u00a0",
    "gr\u00f6\u00dfe", "\U0001f916", "\u202e", "POLYGON", "POLYGON EMPTY", "POINT Z (1 2 3)",
    "MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)))",
    "GEOMETRYCOLLECTION (" * 300, "object(utak).", "object(start, next).", "utak", "verge", "square", "table(0, 0).",
    "table(4096, 4096).", "f(" * 70 + "x" + ")" * 70, "p" * 5000, "{a;b}.", "not a.", "1 2 3", "<xml/>", "asp 1 0 0\n",
)  # fmt: skip


def spoil(draw: random.Random, text: str) -> bytes:
    """Return a text after one to four mutations, as bytes."""
    return spoil_bytes(draw, text.encode())


def spoil_bytes(draw: random.Random, raw: bytes) -> bytes:
    """Return the bytes of a file after one to four mutations."""
    for _ in range(draw.choice([1, 1, 1, 2, 4])):
        raw = draw.choice(MUTATIONS)(draw, raw)
    return raw


def _byte(draw: random.Random, raw: bytes) -> bytes:
    at = draw.randrange(len(raw) + 1)
    return raw[:at] + bytes([draw.randrange(256)]) + raw[at + draw.randrange(2) :]


def _cut(draw: random.Random, raw: bytes) -> bytes:
    start, end = sorted(draw.randrange(len(raw) + 1) for _ in range(2))
    return draw.choice([raw[:start], raw[end:], raw[:start] + raw[end:]])


def _repeat(draw: random.Random, raw: bytes) -> bytes:
    start, end = sorted(draw.randrange(len(raw) + 1) for _ in range(2))
    return raw[:end] + raw[start:end] * draw.choice([1, 1, 2, 50]) + raw[end:]


def _insert(draw: random.Random, raw: bytes) -> bytes:
    at = draw.randrange(len(raw) + 1)
    return raw[:at] + draw.choice(STRAY_WORDS).encode() + raw[at:]


def _replace_word(draw: random.Random, raw: bytes) -> bytes:
    words = list(re.finditer(rb"\w+|[^\w\s]", raw))
    if not words:
        return raw
    word = draw.choice(words)
    other = draw.choice([draw.choice(STRAY_WORDS).encode(), draw.choice(words).group(), b""])
    return raw[: word.start()] + other + raw[word.end() :]


def _replace_number(draw: random.Random, raw: bytes) -> bytes:
    numbers = list(re.finditer(rb"-?\d+(\.\d+)?", raw))
    if not numbers:
        return raw
    number = draw.choice(numbers)
    other = draw.choice(
        ["0", "-1", "1e-12", "1e12", "4.0000000001", str(draw.uniform(-5, 20)), str(draw.randrange(20))]
    )
    return raw[: number.start()] + other.encode() + raw[number.end() :]


def _swap_letters(draw: random.Random, raw: bytes) -> bytes:
    at = draw.randrange(max(1, len(raw) - 1))
    return raw[:at] + raw[at : at + 2][::-1] + raw[at + 2 :]


def _flip_bit(draw: random.Random, raw: bytes) -> bytes:
    if not raw:
        return raw
    at = draw.randrange(len(raw))
    return raw[:at] + bytes([raw[at] ^ (1 << draw.randrange(8))]) + raw[at + 1 :]


def _swap_parts(draw: random.Random, raw: bytes) -> bytes:
    a, b, c, d = sorted(draw.randrange(len(raw) + 1) for _ in range(4))
    return raw[:a] + raw[c:d] + raw[b:c] + raw[a:b] + raw[d:]


def _lines(draw: random.Random, raw: bytes) -> bytes:
    lines = raw.splitlines(keepends=True) or [b""]
    line = draw.choice(lines)
    if draw.random() < 0.5:
        lines.remove(line)
    else:
        lines.insert(draw.randrange(len(lines) + 1), line)
    return b"".join(lines)


def _encoding(draw: random.Random, raw: bytes) -> bytes:
    text = raw.decode("latin-1")
    return draw.choice(
        [text.encode("utf-16"), text.encode("utf-16-be"), text.encode("utf-8-sig"), raw.replace(b"\n", b"\r\n")]
    )


MUTATIONS: tuple[Callable[[random.Random, bytes], bytes], ...] = (
    _byte, _cut, _repeat, _insert, _insert, _replace_word, _replace_word, _replace_number, _replace_number,
    _swap_letters, _swap_parts, _flip_bit, _lines, _encoding,
)  # fmt: skip
