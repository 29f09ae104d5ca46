// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Writes a film as EXR or PNG through OpenImageIO, in place of what was there or not at all. */
#include "sunfleck/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <strings.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <vector>

extern "C" {
#include "base/atomic_file.h"
}

namespace {

// Rows that are converted and handed over at a time: two of the 16-row blocks that EXR
// compresses, so that memory stays a few rows whatever the film's size.
constexpr uint32_t block_rows = 32;

// What is thrown here and turned into a status at the C boundary.
struct failure {
    sf_status status;
    std::string message;
};

[[noreturn]] void fail_io(const std::string &path, const std::string &reason) {
    throw failure{SF_STATUS_IO, "cannot write " + path + ": " + reason};
}

sf_status report(sf_error *error, sf_status status, const char *message) noexcept {
    if (error) {
        error->status = status;
        std::snprintf(error->message, sizeof error->message, "%s", message);
    }
    return status;
}

// A stream into a new file, that takes the place of `path` by commit() and is removed otherwise.
class replacing_file {
   public:
    explicit replacing_file(const std::string &path) : path_(path) {
        sf_error error;
        if (sf_atomic_file_open_unique(&file_, path.c_str(), &error)) throw failure{error.status, error.message};
        const int descriptor = dup(file_.file);
        if (descriptor >= 0) stream_ = fdopen(descriptor, "wb");
        if (stream_) return;
        const int reason = errno;
        if (descriptor >= 0) close(descriptor);
        sf_atomic_file_abandon(&file_);
        fail_io(path_, std::strerror(reason));
    }
    replacing_file(const replacing_file &) = delete;
    replacing_file &operator=(const replacing_file &) = delete;
    ~replacing_file() {
        if (stream_) std::fclose(stream_);
        sf_atomic_file_abandon(&file_);
    }

    FILE *stream() const { return stream_; }

    // A full disk may show as late as fsync or close: only what has reached the disk takes the place.
    void commit() {
        const bool flushed = std::fflush(stream_) == 0 && !std::ferror(stream_);
        const int flush_reason = errno;
        const bool closed = std::fclose(stream_) == 0;
        stream_ = nullptr;
        if (!flushed || !closed) fail_io(path_, std::strerror(flushed ? errno : flush_reason));
        sf_error error;
        if (sf_atomic_file_commit(&file_, &error)) throw failure{error.status, error.message};
    }

   private:
    std::string path_;
    sf_atomic_file file_;
    FILE *stream_ = nullptr;
};

// Rows first .. first + count - 1 of a channel as floats, into every `step`-th place of `out`.
void gather(const sf_channel &channel, uint32_t width, uint32_t first, uint32_t count, size_t step, float *out) {
    for (uint32_t row = first; row < first + count; ++row) {
        const char *pixel = static_cast<const char *>(channel.data) + row * channel.row_stride;
        for (uint32_t column = 0; column < width; ++column, pixel += channel.pixel_stride, out += step) {
            switch (channel.type) {
                case SF_CHANNEL_FLOAT32: std::memcpy(out, pixel, sizeof *out); break;
                case SF_CHANNEL_UINT32: {
                    uint32_t value;
                    std::memcpy(&value, pixel, sizeof value);
                    *out = static_cast<float>(value);
                    break;
                }
                case SF_CHANNEL_UINT8: *out = static_cast<float>(*reinterpret_cast<const uint8_t *>(pixel)); break;
            }
        }
    }
}

// The sRGB transfer function (IEC 61966-2-1), then rounding to the nearest of 256 codes. What
// is not above 0, NaN included, gives 0.
uint8_t encode_srgb(float linear) {
    if (!(linear > 0.0f)) return 0;
    const float v = std::min(linear, 1.0f);
    const float encoded = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
    return static_cast<uint8_t>(encoded * 255.0f + 0.5f);
}

enum class format { exr, png };

format format_of(const char *path) {
    const char *dot = std::strrchr(path, '.');
    if (dot && strcasecmp(dot, ".exr") == 0) return format::exr;
    if (dot && strcasecmp(dot, ".png") == 0) return format::png;
    throw failure{SF_STATUS_INVALID_VALUE, std::string("path is \"") + path + "\"; it must end in .exr or .png"};
}

// The channels that the format keeps: EXR all, PNG the first of the names R, G and B.
std::vector<sf_channel> channels_of(const sf_film *film, format kind) {
    std::vector<sf_channel> channels;
    for (size_t i = 0; i < sf_film_channel_count(film); ++i) {
        const sf_channel channel = sf_film_channel(film, i);
        const bool color = std::strlen(channel.name) == 1 && std::strchr("RGB", channel.name[0]);
        if (kind == format::exr || color) channels.push_back(channel);
    }
    return channels;
}

OIIO::ImageSpec describe(const sf_film *film, const std::vector<sf_channel> &channels, format kind) {
    OIIO::ImageSpec spec(static_cast<int>(sf_film_width(film)), static_cast<int>(sf_film_height(film)),
                         static_cast<int>(channels.size()),
                         kind == format::exr ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    spec.channelnames.clear();
    spec.alpha_channel = -1;
    for (const sf_channel &channel : channels) {
        if (std::strcmp(channel.name, "A") == 0) spec.alpha_channel = static_cast<int>(spec.channelnames.size());
        spec.channelnames.emplace_back(channel.name);
    }
    spec.attribute("Software", "sunfleck");
    spec.attribute("oiio:ColorSpace", kind == format::exr ? "Linear" : "sRGB");
    if (kind == format::exr) {
        spec.attribute("compression", "zip");
        for (size_t i = 0; i < sf_film_attribute_count(film); ++i) {
            const sf_attribute attribute = sf_film_attribute(film, i);
            spec.attribute(std::string("sunfleck:") + attribute.name, attribute.text);
        }
    }
    return spec;
}

// Some rows as floats, and as the codes that a PNG holds.
struct block {
    block(size_t values, format kind) : linear(values), encoded(kind == format::png ? values : 0) {}
    std::vector<float> linear;
    std::vector<uint8_t> encoded;
};

// Hands the channels over a block at a time. False where OpenImageIO refused.
bool write_rows(OIIO::ImageOutput &output, const std::vector<sf_channel> &channels, uint32_t width, uint32_t height,
                format kind, block &rows) {
    for (uint32_t row = 0; row < height; row += block_rows) {
        const uint32_t count = std::min(block_rows, height - row);
        for (size_t i = 0; i < channels.size(); ++i)
            gather(channels[i], width, row, count, channels.size(), rows.linear.data() + i);

        OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT;
        const void *data = rows.linear.data();
        if (kind == format::png) {
            std::transform(rows.linear.begin(), rows.linear.end(), rows.encoded.begin(), encode_srgb);
            type = OIIO::TypeDesc::UINT8;
            data = rows.encoded.data();
        }
        if (!output.write_scanlines(static_cast<int>(row), static_cast<int>(row + count), 0, type, data)) return false;
    }
    return true;
}

void write(const sf_film *film, const std::string &path) {
    const format kind = format_of(path.c_str());
    const std::vector<sf_channel> channels = channels_of(film, kind);

    // Before anything is opened: an encoder that is closed without a row complains on stderr.
    block rows(size_t{block_rows} * sf_film_width(film) * channels.size(), kind);

    // The encoder comes last, so that it is gone before the stream that it writes through.
    replacing_file file(path);
    OIIO::Filesystem::IOFile proxy(file.stream(), OIIO::Filesystem::IOProxy::Write);
    const auto output = OIIO::ImageOutput::create(kind == format::exr ? "exr" : "png");
    if (!output) throw failure{SF_STATUS_BACKEND, "OpenImageIO: " + OIIO::geterror()};
    if (!output->set_ioproxy(&proxy)) throw failure{SF_STATUS_BACKEND, "OpenImageIO: " + output->geterror()};
    const bool written = output->open(path, describe(film, channels, kind)) &&
                         write_rows(*output, channels, sf_film_width(film), sf_film_height(film), kind, rows);
    const bool closed = output->close();
    if (!written || !closed) {
        const std::string reason = output->geterror();
        fail_io(path, reason.empty() ? "OpenImageIO gives no reason" : reason);
    }
    file.commit();
}

}  // namespace

sf_status sf_image_write(const sf_film *film, const char *path, sf_error *error) {
    if (!film) return report(error, SF_STATUS_INVALID_VALUE, "film is NULL; it must be one that sf_render made");
    if (!path) return report(error, SF_STATUS_INVALID_VALUE, "path is NULL; it must end in .exr or .png");
    try {
        write(film, path);
        return SF_STATUS_OK;
    } catch (const failure &f) {
        return report(error, f.status, f.message.c_str());
    } catch (const std::bad_alloc &) {
        return report(error, SF_STATUS_OUT_OF_MEMORY, "out of memory while writing an image");
    } catch (const std::exception &e) {
        return report(error, SF_STATUS_BACKEND, e.what());
    } catch (...) {
        return report(error, SF_STATUS_BACKEND, "OpenImageIO threw something unknown");
    }
}
