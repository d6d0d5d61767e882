"""Manifests and hashes as the program writes them, to make files that are whole and wrong."""

import ctypes
import functools
import json
import subprocess
import tempfile

SOURCE = r"""
#define XXH_INLINE_ALL
#include <xxhash.h>
unsigned long long hash64(const void* bytes, size_t size) { return XXH3_64bits(bytes, size); }
void hash128(const void* bytes, size_t size, unsigned long long* out) {
  const XXH128_hash_t hash = XXH3_128bits(bytes, size);
  out[0] = hash.high64;
  out[1] = hash.low64;
}
"""


@functools.cache
def library():
    folder = tempfile.mkdtemp()
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-x", "c", "-o", f"{folder}/xxh3.so", "-"], input=SOURCE.encode(), check=True)
    loaded = ctypes.CDLL(f"{folder}/xxh3.so")
    loaded.hash64.restype = ctypes.c_ulonglong
    return loaded


def hash64(data):
    return library().hash64(data, ctypes.c_size_t(len(data)))


def hash_hex(data):
    out = (ctypes.c_ulonglong * 2)()
    library().hash128(data, ctypes.c_size_t(len(data)), out)
    return f"{out[0]:016x}{out[1]:016x}"


def rehash(folder, drop=()):
    """Makes the manifest of a trial agree with what lies in its folder."""
    path = folder / "manifest.json"
    manifest = json.loads(path.read_text())
    files = [folder / file["name"] for file in manifest["files"] if file["name"] not in drop]
    manifest["files"] = [
        {"name": file.name, "size": file.stat().st_size, "hash": hash_hex(file.read_bytes())} for file in files
    ]
    manifest.pop("hash")
    manifest["hash"] = hash_hex(dumped(manifest))
    path.write_bytes(dumped(manifest) + b"\n")


def dumped(manifest):
    return json.dumps(manifest, indent=1, sort_keys=True, ensure_ascii=False).encode()
