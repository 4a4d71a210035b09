"""Writes the sample files of weights: tests/fuzz/corpus/weights. Needs nothing but Python.

    python3 tests/tools/make_weights.py

Classes of PyTorch are stood in for by empty ones of the same names, which is all that a pickle records. spec_*: files that torch 1.13
and joblib 1.2 wrote, from the specification; they are not made here.
"""
import argparse
import collections
import enum
import functools
import gzip
import io
import os
import pickle
import struct
import sys
import types
import zipfile
import zlib
from collections import OrderedDict

folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), '../fuzz/corpus/weights')


def module(name, **members):
    for end in [i for i, c in enumerate(name) if c == '.' and i > 0]:
        sys.modules.setdefault(name[:end], types.ModuleType(name[:end]))
    m = sys.modules[name] = types.ModuleType(name)
    for key, value in members.items():
        value.__module__, value.__name__, value.__qualname__ = name, key, key
        setattr(m, key, value)
    parent, _, last = name.rpartition('.')
    if parent:
        setattr(sys.modules[parent], last, m)
    return m


def stub(*arguments):
    raise RuntimeError('only recorded')


class Call:
    """An object that is pickled as a call."""

    def __init__(self, function, *arguments):
        self.call = function, arguments

    def __reduce__(self):
        return self.call


def function(name):
    return types.FunctionType(stub.__code__, {}, name)


storages = {n + 'Storage': type(n + 'Storage', (), {}) for n in ('Float', 'Double', 'Half', 'Long', 'Bool', 'QInt8', 'ComplexFloat')}
torch = module('torch', **storages, float32=type('float32', (), {}))
utils = module('torch._utils', **{n: function(n) for n in (
    '_rebuild_tensor', '_rebuild_tensor_v2', '_rebuild_tensor_v3', '_rebuild_parameter', '_rebuild_parameter_with_state')})
storage = module('torch.storage', UntypedStorage=type('UntypedStorage', (), {}), _load_from_bytes=function('_load_from_bytes'))
nobody = module('nobody', Config=type('Config', (), {}), Settings=type('Settings', (dict,), {}),
                Slots=type('Slots', (), {'__slots__': ('latent_dim',)}),
                SlotsToo=type('SlotsToo', (), {'__slots__': ('latent_dim', '__dict__')}),
                Frozen=type('Frozen', (), {'__reduce__': lambda _: (nobody.Frozen, ({'latent_dim': 256, 'name': 'temos'},))}),
                Keywords=type('Keywords', (), {'__getnewargs_ex__': lambda self: ((), {'latent_dim': 256})}),
                Ordered=type('Ordered', (OrderedDict,), {}), Mode=enum.Enum('Mode', {'train': 'training'}))


class Storage:
    def __init__(self, kind, key, count, view=()):
        self.id = ('storage', kind, key, 'cpu', count) + view


class Pickler(pickle._Pickler):
    def persistent_id(self, value):
        return value.id if isinstance(value, Storage) else None


def pickled(value, protocol=2):
    out = io.BytesIO()
    Pickler(out, protocol).dump(value)
    return out.getvalue()


def tensor(s, offset, size, stride):
    return Call(utils._rebuild_tensor_v2, s, offset, size, stride, False, OrderedDict())


def archive(name, value, data, root='archive', order=None, more=(), deflated=False):
    with zipfile.ZipFile(os.path.join(folder, name), 'w') as z:
        def put(member, content, method=zipfile.ZIP_STORED):
            z.writestr(zipfile.ZipInfo(root + '/' + member), content, method)
        put('data.pkl', value if isinstance(value, bytes) else pickled(value))
        if order:
            put('byteorder', order)
        for key, content in data.items():
            put('data/' + key, content, zipfile.ZIP_DEFLATED if deflated else zipfile.ZIP_STORED)
        for member in more:
            put(member, 'def forward(self): return 1\n' * 10, zipfile.ZIP_DEFLATED)
        put('version', '3\n')


def legacy(value, data, little=True):
    return (bytes.fromhex('80028A0A6CFC9C46F920 6AA850192E'.replace(' ', '')) + pickled(1001) +
            pickled({'protocol_version': 1001, 'little_endian': little, 'type_sizes': {'short': 2, 'int': 4, 'long': 4}}) +
            pickled(value) + pickled(list(data)) + b''.join(struct.pack('<q', n) + raw for n, raw in data.values()))


def write(name, content):
    with open(os.path.join(folder, name), 'wb') as f:
        f.write(content)


def floats(*values, order='<'):
    return struct.pack(order + '%df' % len(values), *values)


six = Storage(torch.FloatStorage, '0', 6)
numbers = floats(0, 1, 2, 3, 4, 5)
plain = tensor(six, 0, (2, 3), (3, 1))

# Order of bytes, packed storages, element types that come with the tensor, and what is not read.
archive('big_endian.pt', {'w': plain, 't': tensor(six, 0, (3, 2), (1, 3))}, {'0': floats(0, 1, 2, 3, 4, 5, order='>')}, order='big')
archive('deflated.pt', {'w': plain}, {'0': numbers}, root='other name', deflated=True)
archive('many_axes.pt', {'w': tensor(six, 0, (1, 2, 1, 1, 3, 1, 1, 1, 1), (6, 3, 3, 3, 1, 1, 1, 1, 1)),
                         'wt': tensor(six, 0, (1,) * 30 + (3, 2), (1,) * 30 + (1, 3)),
                         'too_many': tensor(six, 0, (1,) * 65, (1,) * 65)}, {'0': numbers})
untyped = Storage(storage.UntypedStorage, '1', 8)
archive('v3.pt', {
    'w': Call(utils._rebuild_tensor_v3, untyped, 0, (2,), (1,), False, OrderedDict(), torch.float32),
    'old': Call(utils._rebuild_tensor, six, 1, (2,), (2,)),
    'parameter': Call(utils._rebuild_parameter, plain, True, OrderedDict()),
    'state': Call(utils._rebuild_parameter_with_state, plain, True, OrderedDict(), {'a': 1}),
    'complex': tensor(Storage(torch.ComplexFloatStorage, '0', 3), 0, (3,), (1,)),
    'quantized': tensor(Storage(torch.QInt8Storage, '1', 8), 0, (8,), (1,)),
}, {'0': numbers, '1': floats(7, 8)})
settings = nobody.Settings()
settings['rate'] = 0.5
config = nobody.Config()
config.hidden = 3
archive('checkpoint.ckpt', {'epoch': 3, 'state_dict': OrderedDict(a=plain, b=tensor(six, 5, (), ())), 'settings': settings,
                            'config': config, nobody.Config: 1, 'optimizer_states': [{'state': {0: {'exp_avg': plain}}, 'lr': 0.1}]},
        {'0': numbers})


# Configurations in objects of classes that nobody knows, in the ways in which pickles hold them.
def filled(made, **fields):
    for name, value in fields.items():
        setattr(made, name, value)
    return made


def configured(made):
    return filled(made, latent_dim=256, name='temos', vae=True, rate=1e-4)


def node(value, parent):
    return filled(nobody.Config(), _val=value, _parent=parent, _metadata=filled(nobody.Config(), optional=True))


def objects(protocol):
    tree = nobody.Config()  # as omegaconf's
    filled(tree, _parent=None, _content={'latent_dim': node(256, tree), 'name': node('temos', tree)})
    tree._content['inner'] = filled(nobody.Config(), _parent=tree, _content={'heads': node(4, tree)})
    loop = configured(nobody.Config())
    loop.again, loop.list = loop, [loop, {'loop': loop}]
    settings = filled(nobody.Settings({'latent_dim': 256}), name='temos')
    repeated = filled(nobody.Settings({'latent_dim': 256, 'name': 'temos'}), latent_dim=256, name='temos')
    nested = filled(nobody.Config(), inner=configured(nobody.Config()), layers=[1, {'heads': 4}], weight=plain,
                    mode=nobody.Mode.train)
    out = {'plain': configured(nobody.Config()), 'nested': nested, 'tree': tree, 'loop': loop, 'settings': settings,
           'repeated': repeated, 'ordered': nobody.Ordered(latent_dim=256), 'frozen': nobody.Frozen(), 'mode': nobody.Mode.train,
           'namespace': configured(argparse.Namespace()), 'simple': configured(types.SimpleNamespace()),
           'user': collections.UserDict(latent_dim=256), 'partial': functools.partial(nobody.Config, 1, latent_dim=256)}
    if protocol >= 2:
        out['slots'] = filled(nobody.Slots(), latent_dim=256)
        out['slots_too'] = filled(nobody.SlotsToo(), latent_dim=256, name='temos')
    if protocol >= 4:
        out['keywords'] = nobody.Keywords()
    return out


for protocol in range(1, 6):
    checkpoint = {'state_dict': OrderedDict(a=plain), 'hyper_parameters': objects(protocol)}
    archive('objects_p%d.ckpt' % protocol, pickled(checkpoint, protocol), {'0': numbers})

# TorchScript: a tree of modules.
script = {}
for cls in ('Model', 'Layer'):
    script[cls] = type(cls, (), {})
module('__torch__.clip.model.___torch_mangle_7', **script)


def part(cls, **fields):
    p = script[cls]()
    p.__dict__.update(fields)
    return p


layers = part('Layer', training=False)
layers.__dict__['0'] = part('Layer', training=False, weight=plain, bias=None)
layers.__dict__['1'] = part('Layer', training=False, weight=tensor(six, 0, (3, 2), (1, 3)))
archive('script.pt', part('Model', training=False, logit_scale=tensor(six, 2, (), ()), width=3, layers=layers), {'0': numbers},
        root='ViT-B', more=('constants.pkl', 'code/__torch__/clip.py'))

# The older form: parts of storages, storages in bytes.
window = Storage(torch.FloatStorage, '17', 6, (('18', 2, 3),))
write('views_legacy.pt', legacy({'w': tensor(Storage(torch.FloatStorage, '17', 6, (None,)), 0, (2, 3), (3, 1)),
                                 'part': tensor(window, 0, (3,), (1,))}, {'17': (6, numbers)}))
inner = legacy(Storage(torch.FloatStorage, '5', 6, (None,)), {'5': (6, numbers)})
write('nested_storage.pkl', pickled({'w': tensor(Call(storage._load_from_bytes, inner), 0, (2, 3), (3, 1))}, 4))

# Files that ask for too much memory.
archive('stride_bomb.pt', {'w': tensor(Storage(torch.FloatStorage, '0', 1), 0, (1 << 40,), (0,))}, {'0': floats(1)})
archive('many_expanded.pt', {str(i): tensor(Storage(torch.DoubleStorage, '0', 1), 0, (1 << 20,), (0,)) for i in range(40)},
        {'0': struct.pack('<d', 1)})
archive('wrapping_sizes.pt', {'w': tensor(six, 0, (1 << 62, 1 << 62, 0), (1, 1, 1))}, {'0': numbers})
write('count_legacy.pt', legacy({'w': tensor(Storage(torch.FloatStorage, '1', 1 << 60, (None,)), 0, (1,), (1,))}, {'1': (1 << 60, b'')}))

joblib = open(os.path.join(folder, 'spec_joblib.pkl'), 'rb').read()
write('joblib_packed.pkl', zlib.compress(joblib))
write('joblib_gzip.pkl', gzip.compress(joblib, mtime=0))
