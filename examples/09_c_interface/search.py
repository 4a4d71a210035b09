"""Search from Python, without any package: python3 search.py libmotionlang_c.so moves.index "a person waves" """
import ctypes
import sys

library, index_file, text = sys.argv[1:4]
ml = ctypes.CDLL(library)
ml.motionlang_message.restype = ctypes.c_char_p
ml.motionlang_hits_count.restype = ctypes.c_int64


class Hit(ctypes.Structure):
    _fields_ = [("path", ctypes.c_char_p), ("name", ctypes.c_char_p), ("caption", ctypes.c_char_p),
                ("license", ctypes.c_char_p), ("start", ctypes.c_double), ("end", ctypes.c_double),
                ("score", ctypes.c_double)]


def check(status):
    if status:
        raise RuntimeError(ml.motionlang_message().decode())


index, hits, hit = ctypes.c_void_p(), ctypes.c_void_p(), Hit()
check(ml.motionlang_open_index(index_file.encode(), None, None, ctypes.byref(index)))
check(ml.motionlang_search_text(index, text.encode(), None, ctypes.byref(hits)))
for i in range(ml.motionlang_hits_count(hits)):
    check(ml.motionlang_hits_at(hits, ctypes.c_int64(i), ctypes.byref(hit)))
    print(f"{hit.score:.3f}  {hit.start:.2f} to {hit.end:.2f} s  {hit.path.decode()}")
ml.motionlang_free_hits(hits)
ml.motionlang_free_index(index)
