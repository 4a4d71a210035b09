#!/usr/bin/python3
"""Writes the pickles of tests/fuzz/corpus/pickle: the synthetic body of the tests in several dialects, and hostile files.

usage: make_pickles.py FOLDER
The body is that of tests/support/synthetic_body.hpp, which computes the same numbers. Needs NumPy. SciPy and
chumpy are imitated: only the names of their classes stand in the files.
"""
import collections, os, pathlib, pickle, struct, sys, types
import numpy as np

FOLDER = pathlib.Path(sys.argv[1])


def fake_class(name):
    module, attribute = name.rsplit(".", 1)
    for i in range(1, module.count(".") + 2):
        part = ".".join(module.split(".")[:i])
        sys.modules.setdefault(part, types.ModuleType(part))
    c = type(attribute, (), {"__module__": module})
    setattr(sys.modules[module], attribute, c)
    return c


Csc, Ch, Select = map(fake_class, ["scipy.sparse.csc.csc_matrix", "chumpy.ch.Ch", "chumpy.reordering.Select"])
MatVecMult = fake_class("chumpy.ch.MatVecMult")


def instance(c, **attributes):
    o = c()
    o.__dict__.update(attributes)
    return o


def s(k, *shape):
    i = np.arange(np.prod(shape))
    return (0.3 * np.sin(0.7 * k + 0.31 * i + 0.01 * i**2)).reshape(shape)


def body():
    rows = lambda a: a / a.sum(1, keepdims=True)
    return {
        "v_template": s(0, 5, 3) + [0, 1, 0],
        "shapedirs": s(1, 5, 3, 2),
        "posedirs": s(2, 5, 3, 27),
        "J_regressor": rows(abs(s(3, 4, 5)) + 0.05),
        "weights": rows(abs(s(4, 5, 4)) + 0.05),
        "kintree_table": np.array([[2**32 - 1, 0, 1, 1], [0, 1, 2, 3]], np.uint32),
        "f": np.array([[0, 1, 2], [0, 2, 3], [2, 3, 4]], np.uint32),
    }


def csc(dense):
    entries = [(c, r, dense[r, c]) for c in range(dense.shape[1]) for r in range(dense.shape[0])]
    starts = [sum(e[0] < c for e in entries) for c in range(dense.shape[1] + 1)]
    return instance(Csc, _shape=dense.shape, data=np.array([e[2] for e in entries]), maxprint=50,
                    indices=np.array([e[1] for e in entries], np.int32), indptr=np.array(starts, np.int32), format="csc")


class Python2Pickler(pickle._Pickler):
    """Texts and bytes as Python 2 wrote them."""

    def save_string(self, obj):
        data = obj.encode("latin1") if isinstance(obj, str) else obj
        self.write(b"U" + bytes([len(data)]) + data if len(data) < 256 else b"T" + struct.pack("<i", len(data)) + data)
        self.memoize(obj)

    dispatch = {**pickle._Pickler.dispatch, str: save_string, bytes: save_string}


def python2(obj, path):
    with open(path, "wb") as f:
        Python2Pickler(f, 2, fix_imports=True).dump(obj)


def write(name, data):
    (FOLDER / name).write_bytes(data)


def bodies():
    b = body()
    for protocol in (0, 2, 4, 5):
        write(f"body_p{protocol}.pkl", pickle.dumps(b, protocol))
    # what the first releases look like: sparse regressor, chumpy nodes, other byte orders, column-major arrays, dead weight
    more = np.concatenate([b["shapedirs"], s(9, 5, 3, 3)], 2)  # Select takes the first two of five directions
    chosen = np.arange(more.size).reshape(more.shape)[:, :, :2].reshape(-1)
    old = {
        **b,
        "shapedirs": instance(Select, a=instance(Ch, x=instance(Ch, x=more)), idxs=chosen, preferred_shape=(5, 3, 2), _dirty_vars=set()),
        "posedirs": np.asfortranarray(b["posedirs"]),
        "J_regressor": csc(b["J_regressor"]),
        "weights": b["weights"].astype(">f8"),
        "v_template": instance(Ch, x=b["v_template"], _itr=None),
        "kintree_table": b["kintree_table"].astype(np.int64),
        "J": instance(MatVecMult, mtx=csc(b["J_regressor"]), vec=instance(Ch, x=b["v_template"][:, 0])),
        "bs_style": "lbs", "bs_type": "lrotmin",
        "pose_training_info": collections.OrderedDict(gender="female", height=1.5),
    }
    python2(old, FOLDER / "body_python2.pkl")


class Call:
    def __init__(self, function, *arguments):
        self.call = function, arguments

    def __reduce__(self):
        return self.call


def values():
    mixed = collections.OrderedDict([
        ("none", None), ("true", True), ("false", False), ("small", 7), ("negative", -70000), ("large", 2**40), ("huge", 2**100),
        ("real", -1.25), ("text", "Gr\u00fc\u00dfe \u2603"), ("bytes", b"\x00\xff"), ("tuple", (1, (2, 3), 4, 5)), ("list", [1, [2]]),
        ("set", {5}), ("complex", 1 + 2j), ("scalar", np.float64(2.5)), ("half", np.array([1, -2], np.float16)),
        ("texts", np.array(["male", "\u00fc"])), ("flags", np.array([True, False])), ("default", collections.defaultdict(list, {"a": 1})),
        ("empty", np.zeros((0, 3))),
    ])
    mixed["again"] = mixed["list"]
    for protocol in range(6):
        write(f"values_p{protocol}.pkl", pickle.dumps(mixed, protocol))
    cyclic = []
    cyclic.append(cyclic)
    write("cyclic.pkl", pickle.dumps(cyclic, 2))


def hostile():
    write("os_system.pkl", pickle.dumps(Call(os.system, "true"), 2))
    write("eval_p0.pkl", pickle.dumps(Call(eval, "1"), 0))
    write("huge_text.pkl", b"\x80\x02X\xff\xff\xff\xff.")
    write("huge_bytes8.pkl", b"\x80\x04\x8e" + b"\xff" * 8 + b".")
    laughs = b"\x80\x02(" + b"K\x01" * 10 + b"tq\x000"  # a tuple of ten of the tuple before, ten times
    for i in range(1, 10):
        laughs += b"(" + b"h%c" % (i - 1) * 10 + b"tq%c0" % i
    write("laughs.pkl", laughs + b"h\x09.")
    write("deep.pkl", b"\x80\x02" + b"]" * 20000 + b"a" * 19999 + b".")
    deep = b"K\x01"
    for _ in range(100):
        deep = b"cchumpy.ch\nCh\n)\x81}X\x01\x00\x00\x00x" + deep + b"sb"
    write("deep_ch.pkl", b"\x80\x02" + deep + b".")
    write("persistent.pkl", b"\x80\x02(X\x07\x00\x00\x00storagectorch\nFloatStorage\nX\x01\x00\x00\x000K\x04tQ.")


FOLDER.mkdir(parents=True, exist_ok=True)
bodies()
values()
hostile()
