#!/usr/bin/python3
"""The tokenizers once more, plain and slow: the published algorithms in Python, with the tables of
Python's unicodedata, the entities of its html module and the published pattern in the regex module (Debian python3-regex).
Nothing is shared with the C++ code. Prints the digests that tests/unit/text/published_tokenizers.cpp compares with.

usage: reference_tokenizers.py DATA      DATA/tokenizers/{bert_vocab.txt,bpe_simple_vocab_16e6.txt.gz}, DATA/text/kitml-annotations.json

Checks itself first on 40 strings, whose ids come from the original implementations. A digest is FNV-1a, 64 bits,
over the ids of all texts in the order of the file, each id as 4 bytes little-endian, each text followed by FF FF FF FF.
"""
import gzip, html, html.entities, json, pathlib, re, sys, unicodedata
import regex

DATA = pathlib.Path(sys.argv[1])
STORED = pathlib.Path(__file__).parent.parent / "unit/text/data"
ROWS = json.loads((STORED / "tokenizer_strings.json").read_text())
FRAGMENTS = json.loads((STORED / "tokenizer_fragments.json").read_text())
category = unicodedata.category
# The White_Space property.
SPACES = set("\t\n\v\f\r \x85\xa0\u1680\u2028\u2029\u202f\u205f\u3000") | {chr(c) for c in range(0x2000, 0x200B)}

# --- BERT and MPNet -------------------------------------------------------------------------------------------------

CJK = [(0x4E00, 0x9FFF), (0x3400, 0x4DBF), (0x20000, 0x2A6DF), (0x2A700, 0x2B73F), (0x2B740, 0x2B81F), (0x2B920, 0x2CEAF),
       (0xF900, 0xFAFF), (0x2F800, 0x2FA1F)]


def bert_words(text):
    kept = ""
    for c in text:
        if c in "\t\n\r":
            kept += " "
        elif c in "\0\ufffd" or category(c) in ("Cc", "Cf", "Cs", "Co"):
            continue
        elif c in SPACES:
            kept += " "
        elif any(a <= ord(c) <= b for a, b in CJK):
            kept += " " + c + " "
        else:
            kept += c
    plain = "".join(c for c in unicodedata.normalize("NFD", kept) if category(c) != "Mn")
    plain = "".join(c.lower() for c in plain)
    spaced = ""
    for c in plain:
        n = ord(c)
        ascii_symbol = 33 <= n <= 47 or 58 <= n <= 64 or 91 <= n <= 96 or 123 <= n <= 126
        spaced += f" {c} " if ascii_symbol or category(c)[0] == "P" else c
    return [w for w in re.split("[" + re.escape("".join(SPACES)) + "]+", spaced) if w]


def word_pieces(word, ids, unknown):
    if len(word) > 100:
        return [unknown]
    out, at = [], 0
    while at < len(word):
        for end in range(len(word), at, -1):
            piece = ("##" if at else "") + word[at:end]
            if piece in ids:
                break
        else:
            return [unknown]
        out.append(ids[piece])
        at = end
    return out


class Bert:
    def __init__(self, pieces, begin, end, special):
        self.ids = {p: i for i, p in enumerate(pieces)}
        self.begin, self.end = self.ids[begin], self.ids[end]
        self.pattern = re.compile("(" + "|".join(map(re.escape, special)) + ")")
        self.special = special

    def __call__(self, text):
        out = [self.begin]
        for part in self.pattern.split(text):
            if part in self.special:
                out.append(self.ids[part])
            else:
                for word in bert_words(part):
                    out += word_pieces(word, self.ids, self.ids["[UNK]"])
        return out + [self.end]


# --- CLIP -----------------------------------------------------------------------------------------------------------

ENTITIES = {}
for name, value in html.entities.html5.items():
    if name.endswith(";"):
        ENTITIES["&" + name] = value
        if name == name.lower() and html.unescape("&" + name.upper()) == "&" + name.upper():
            ENTITIES["&" + name.upper()] = value.upper()


def entity(match):
    text = match.group(0)
    if text in ENTITIES:
        return ENTITIES[text]
    if text.startswith("&#"):
        value = html.unescape(text)
        return text if ";" in value else value
    return text


def windows_1252(c):
    try:
        return bytes([ord(c)]).decode("cp1252")
    except UnicodeDecodeError:
        return c


CHARACTERS = {c: windows_1252(chr(c)) for c in range(0x80, 0xA0)}
LIGATURES = dict(zip("ĳĲŉǆǅǄǉǈǇǌǋǊǳǲǱﬀﬁﬂﬃﬄﬅﬆ",
                     "ij IJ ʼn dž Dž DŽ lj Lj LJ nj Nj NJ dz Dz DZ ff fi fl ffi ffl ſt st".split()))
WIDTHS = {0x3000: " "} | {c: unicodedata.normalize("NFKC", chr(c)) for c in range(0xFF01, 0xFFF0)}
QUOTES = {c: "'" for c in [0x2BC, 0x2018, 0x2019, 0x201A, 0x201B]} | {c: '"' for c in range(0x201C, 0x2020)}
CONTROLS = {c: None for c in [*range(9), 0xB, *range(0xE, 0x20), 0x7F, *range(0x206A, 0x2070), 0xFEFF, *range(0xFFF9, 0xFFFD)]}


def repaired_line(text, markup):
    for _ in range(100):
        before = text
        if not markup:
            text = re.sub("&#?[0-9A-Za-z]{1,24};", entity, text)
        text = text.translate(CHARACTERS)
        for ligature, letters in LIGATURES.items():
            text = text.replace(ligature, letters)
        text = text.translate(WIDTHS).translate(QUOTES)
        for end in ["\r\n", "\r", "\u2028", "\u2029", "\x85"]:
            text = text.replace(end, "\n")
        text = re.sub("\x1b\\[[0-9;]*[a-zA-Z]", "", text).translate(CONTROLS)
        text = unicodedata.normalize("NFC", text)
        if text == before:
            break
    return text


def repaired(text):
    out, markup = "", False
    for line in re.findall("[^\n]*\n|[^\n]+", text):
        markup = markup or "<" in line
        out += repaired_line(line, markup)
    return out


def byte_symbols():
    printable = [*range(0x21, 0x7F), *range(0xA1, 0xAD), *range(0xAE, 0x100)]
    out, extra = {b: chr(b) for b in printable}, 0
    for b in range(256):
        if b not in out:
            out[b] = chr(256 + extra)
            extra += 1
    return out


class Clip:
    pattern = (r"<\|startoftext\|>|<\|endoftext\|>|'s|'t|'re|'ve|'m|'ll|'d|[\p{L}]+|[\p{N}]|[^\s\p{L}\p{N}]+")

    def __init__(self, lines, hugging_face=False):
        merges = [tuple(line.split()) for line in lines[1:49152 - 256 - 2 + 1]]
        self.symbols = byte_symbols()
        singles = list(self.symbols.values())
        pieces = singles + [s + "</w>" for s in singles] + ["".join(m) for m in merges]
        self.special = ["<|startoftext|>", "<|endoftext|>"]
        self.ids = {p: i for i, p in enumerate(pieces + self.special)}
        self.ranks = {m: i for i, m in enumerate(merges)}
        self.known = {}
        self.hugging_face = hugging_face

    def words(self, text):
        if self.hugging_face:
            text = regex.sub(r"\s+", " ", unicodedata.normalize("NFC", text))
            text = "".join(c.lower() for c in text)
        else:
            text = html.unescape(html.unescape(repaired(text))).strip()
            text = regex.sub(r"\s+", " ", text).strip().lower()
        return regex.findall(self.pattern, text, 0 if self.hugging_face else regex.IGNORECASE)

    def word(self, word):
        if word in self.special:
            return [self.ids[word]]
        if word not in self.known:
            parts = [self.symbols[b] for b in word.encode()]
            parts[-1] += "</w>"
            while len(parts) > 1:
                best = min(zip(parts, parts[1:]), key=lambda pair: self.ranks.get(pair, 1 << 30))
                if best not in self.ranks:
                    break
                merged, at = [], 0
                while at < len(parts):
                    if tuple(parts[at:at + 2]) == best:
                        merged.append(parts[at] + parts[at + 1])
                        at += 2
                    else:
                        merged.append(parts[at])
                        at += 1
                parts = merged
            self.known[word] = [self.ids[p] for p in parts]
        return self.known[word]

    def __call__(self, text):
        return [i for w in self.words(text) for i in self.word(w)]


# --- digests --------------------------------------------------------------------------------------------------------

def digest(tokenizer, texts):
    h, count = 0xCBF29CE484222325, 0
    for text in texts:
        ids = tokenizer(text)
        count += len(ids)
        for b in b"".join(i.to_bytes(4, "little") for i in [*ids, 0xFFFFFFFF]):
            h = (h ^ b) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return f"{len(texts)} texts, {count} ids, {h:016x}"


def decorated(i, caption):
    """A caption with one of the 40 strings in its middle: captions alone are plain ASCII."""
    at = 7 * i % (len(caption) + 1)
    return caption[:at] + ROWS[i % len(ROWS)]["text"] + caption[at:]


def mixed(count):
    """Texts of 1 to 12 fragments: entities and their parts, marks, controls, ..."""
    state = 1

    def below(n):
        nonlocal state
        state = (state * 1664525 + 1013904223) % 2**32
        return (state >> 16) % n

    for _ in range(count):
        size = 1 + below(12)
        yield "".join([FRAGMENTS[below(len(FRAGMENTS))] for _ in range(size)])


vocabulary = (DATA / "tokenizers/bert_vocab.txt").read_text(encoding="utf-8").split("\n")[:-1]
bert = Bert(vocabulary, "[CLS]", "[SEP]", ["[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]"])
mpnet = Bert(["<s>", "<pad>", "</s>", "<unk>", *vocabulary, "<mask>"], "<s>", "</s>",
             ["<s>", "<pad>", "</s>", "<unk>", "[UNK]", "<mask>"])
merge_lines = gzip.open(DATA / "tokenizers/bpe_simple_vocab_16e6.txt.gz").read().decode().split("\n")
clip, clip_hf = Clip(merge_lines), Clip(merge_lines, hugging_face=True)

for row in ROWS:
    expected = row.get("mpnet") or [{101: 0, 102: 2}.get(b, b + 4) for b in row["bert"]]
    for name, got, want in [("bert", bert(row["text"]), row["bert"]), ("mpnet", mpnet(row["text"]), expected),
                            ("clip", clip(row["text"]), row["clip"])]:
        if got != want and (name, row["name"]) != ("clip", "mojibake"):
            sys.exit(f"{name} of '{row['name']}': {got}, expected {want}")

captions = [a["text"] for entry in json.loads((DATA / "text/kitml-annotations.json").read_text()).values()
            for a in entry["annotations"]]
sets = {"captions": captions, "decorated": [decorated(i, c) for i, c in enumerate(captions)],
        "mixed": list(mixed(50000))}
for set_name, texts in sets.items():
    for name, tokenizer in [("bert", bert), ("mpnet", mpnet), ("clip", clip), ("clip_hf", clip_hf)]:
        print(set_name, name, digest(tokenizer, texts), flush=True)
