#include "unpack.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "../most_bytes.h"
#include "delio/core/error.h"

namespace delio::io {
namespace {
using Buffer = std::vector<std::uint8_t>;

/** What one call of a library took and gave. */
struct Progress {
    std::size_t taken = 0, given = 0;
    bool ended = false;
};

[[noreturn]] void damaged(const std::string& compression) {
    throw Error("is damaged: a chunk's " + compression + " data cannot be unpacked");
}

/** Calls `step(from, bytes, to, room)` until its frame ends. */
template <typename Step>
void unpackBy(const std::string& name, const Buffer& packed, std::uint64_t size, Buffer& out,
              const Step& step) {
    // Memory grows with what comes out, at first by copies, then in place: large memory that is
    // reserved takes none until it is written to.
    constexpr std::uint64_t kFirst = 1 << 20, kCopied = 16 << 20;
    std::size_t taken = 0, given = 0;
    for (bool ended = false; !ended;) {
        // One byte of room more than announced tells a chunk that is longer.
        if (given == out.size() || out.empty()) {
            if (given >= kCopied) out.reserve(size + 1);
            out.resize(std::min(size + 1, std::max<std::uint64_t>(kFirst, 2 * given)));
        }
        const Progress progress = step(packed.data() + taken, packed.size() - taken,
                                       out.data() + given, out.size() - given);
        taken += progress.taken;
        given += progress.given;
        ended = progress.ended;
        const bool stuck = progress.taken == 0 && progress.given == 0;
        if (given > size || (!ended && stuck)) damaged(name);
    }
    if (given != size) damaged(name);
    out.resize(given);
}

void unpackBz2(const Buffer& packed, std::uint64_t size, Buffer& out) {
    bz_stream stream{};
    if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
    const std::unique_ptr<bz_stream, int (*)(bz_stream*)> owner(&stream, BZ2_bzDecompressEnd);
    unpackBy(
        "bz2", packed, size, out,
        [&](const std::uint8_t* from, std::size_t bytes, std::uint8_t* to, std::size_t room) {
            constexpr std::size_t kMost = 1 << 30;
            const auto in = static_cast<unsigned>(std::min(bytes, kMost));
            const auto free = static_cast<unsigned>(std::min(room, kMost));
            // bzlib reads through a pointer that is not const.
            stream.next_in = reinterpret_cast<char*>(const_cast<std::uint8_t*>(from));
            stream.avail_in = in;
            stream.next_out = reinterpret_cast<char*>(to);
            stream.avail_out = free;
            const int code = BZ2_bzDecompress(&stream);
            if (code != BZ_OK && code != BZ_STREAM_END) damaged("bz2");
            return Progress{in - stream.avail_in, free - stream.avail_out, code == BZ_STREAM_END};
        });
}

void unpackLz4(const Buffer& packed, std::uint64_t size, Buffer& out) {
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)))
        throw std::bad_alloc();
    const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> owner(
        context, LZ4F_freeDecompressionContext);
    unpackBy("lz4", packed, size, out,
             [&](const std::uint8_t* from, std::size_t bytes, std::uint8_t* to, std::size_t room) {
                 const std::size_t code =
                     LZ4F_decompress(context, to, &room, from, &bytes, nullptr);
                 if (LZ4F_isError(code)) damaged("lz4");
                 return Progress{bytes, room, code == 0};
             });
}

void unpackZstd(const Buffer& packed, std::uint64_t size, Buffer& out) {
    const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                          ZSTD_freeDCtx);
    if (!context) throw std::bad_alloc();
    unpackBy("zstd", packed, size, out,
             [&](const std::uint8_t* from, std::size_t bytes, std::uint8_t* to, std::size_t room) {
                 ZSTD_inBuffer in{from, bytes, 0};
                 ZSTD_outBuffer free{nullptr, room, 0};
                 free.dst = to;
                 const std::size_t code = ZSTD_decompressStream(context.get(), &free, &in);
                 if (ZSTD_isError(code)) damaged("zstd");
                 return Progress{in.pos, free.pos, code == 0};
             });
}
}  // namespace

void unpack(const std::string& compression, const Buffer& packed, std::uint64_t size, Buffer& out) {
    if (size > kMostBytes)
        throw Error("is damaged: a chunk of " + std::to_string(size) + " bytes is announced");
    out.clear();
    if (compression == "bz2")
        unpackBz2(packed, size, out);
    else if (compression == "lz4")
        unpackLz4(packed, size, out);
    else if (compression == "zstd")
        unpackZstd(packed, size, out);
    else
        throw Error("has a chunk of the unknown compression '" + compression + "'");
}
}  // namespace delio::io
