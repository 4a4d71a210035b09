# Packs a file, as FILE.gz: cmake -D FILE=motionlang_wasm.wasm -P gzip.cmake
file(ARCHIVE_CREATE OUTPUT ${FILE}.gz PATHS ${FILE} FORMAT raw COMPRESSION GZip MTIME 0)
