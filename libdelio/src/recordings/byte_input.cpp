#include "byte_input.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "delio/core/error.h"
#include "files/input_file.h"

namespace delio::io {
namespace {
using Buffer = std::vector<std::uint8_t>;

/** Bytes consumed and produced by one call of a decompression library. */
struct Progress {
    std::size_t taken = 0, given = 0;
    bool ended = false;
};

[[noreturn]] void damaged(const std::string& compression) {
    throw Error("is damaged: " + compression + " data of a chunk cannot be decompressed");
}

/** Calls `step(from, bytes, to, room)` until its frame ends. */
template <typename Step>
void unpackBy(const std::string& name, const Buffer& packed, std::uint64_t size, Buffer& out,
              const Step& step) {
    // Memory grows with the decompressed data, at first by copies, then in place: large reserved
    // memory costs nothing until it is written.
    constexpr std::uint64_t kFirst = 1 << 20, kCopied = 16 << 20;
    std::size_t taken = 0, given = 0;
    for (bool ended = false; !ended;) {
        // One byte of room more than announced reveals a chunk that is longer.
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
        throw Error("is damaged: a chunk claims " + std::to_string(size) + " bytes");
    out.clear();
    if (compression == "bz2")
        unpackBz2(packed, size, out);
    else if (compression == "lz4")
        unpackLz4(packed, size, out);
    else if (compression == "zstd")
        unpackZstd(packed, size, out);
    else
        throw Error("uses the unsupported compression '" + compression + "'");
}

namespace {
constexpr std::size_t kBuffer = 1 << 18;
}

void ByteInput::read(void* to, std::uint64_t bytes) {
    if (bytes > left()) tooShort();
    if (bytes == 0) return;
    get(to, bytes);
    position_ += bytes;
}

void ByteInput::check(std::uint64_t bytes) const {
    if (bytes > left()) tooShort();
    if (bytes > kMostBytes)
        throw Error("is damaged: " + std::to_string(bytes) + " bytes are claimed for one block");
}

void ByteInput::read(std::vector<std::uint8_t>& to, std::uint64_t bytes) {
    check(bytes);
    to.resize(bytes);
    read(to.data(), bytes);
}

void ByteInput::skip(std::uint64_t bytes) {
    if (bytes > left()) tooShort();
    pass(bytes);
    position_ += bytes;
}

std::string ByteInput::text() {
    const auto length = number<std::uint32_t>();
    check(length);
    std::string text(length, '\0');
    read(text.data(), length);
    return text;
}

Bytes ByteInput::view(std::vector<std::uint8_t>& buffer, std::uint64_t bytes) {
    read(buffer, bytes);
    return {buffer.data(), buffer.size()};
}

FileInput::FileInput(const std::string& path) {
    std::error_code fault;
    bytes_ = std::filesystem::file_size(path, fault);
    file_ = fault ? nullptr : std::fopen(path.c_str(), "rb");
    if (!file_) throw Error("cannot be opened");
    std::setvbuf(file_, nullptr, _IOFBF, kBuffer);
    start(bytes_);
}

FileInput::~FileInput() { std::fclose(file_); }

void FileInput::seek(std::uint64_t position) {
    if (position > bytes_) throw Error("is cut off at byte " + std::to_string(bytes_));
    if (fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) throw Error("cannot be read");
    start(bytes_, position);
}

void FileInput::get(void* to, std::size_t bytes) {
    if (std::fread(to, 1, bytes, file_) != bytes) throw Error("cannot be read");
}

void FileInput::pass(std::uint64_t bytes) {
    // A seek discards the read-ahead buffer, so small steps are read instead.
    char scratch[4096];
    if (bytes <= sizeof(scratch))
        get(scratch, bytes);
    else if (fseeko(file_, static_cast<off_t>(bytes), SEEK_CUR) != 0)
        throw Error("cannot be read");
}

void FileInput::tooShort() const {
    throw Error("is cut off: at byte " + std::to_string(position()) +
                " more data is claimed than its " + std::to_string(bytes_) + " bytes");
}

Bytes MemoryInput::view(std::vector<std::uint8_t>&, std::uint64_t bytes) {
    const std::uint64_t begin = position();
    skip(bytes);
    return {bytes_.data() + begin, bytes};
}

void MemoryInput::get(void* to, std::size_t bytes) {
    std::memcpy(to, bytes_.data() + position(), bytes);
}

void MemoryInput::tooShort() const {
    throw Error("is damaged: a chunk of " + std::to_string(bytes_.size()) +
                " bytes claims more data at byte " + std::to_string(position()));
}
}  // namespace delio::io
