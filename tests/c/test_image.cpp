// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* Compiled together with image.cpp and, in place of the renderer, with the film below, so that
 * every value that should come back is known. C++ because it reads through OpenImageIO. */

#include <OpenImageIO/imageio.h>
#include <dirent.h>
#include <setjmp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <set>
#include <sstream>
#include <string>
#include <vector>

extern "C" {
#include <cmocka.h>
}

#include "sunfleck/image.h"

struct sf_film {
    uint32_t width, height;
    std::vector<float> color, alpha, half_width;
    std::vector<uint32_t> samples;
    std::vector<uint8_t> stop_reason;
};

uint32_t sf_film_width(const sf_film *film) { return film->width; }
uint32_t sf_film_height(const sf_film *film) { return film->height; }
size_t sf_film_channel_count(const sf_film *) { return 7; }
sf_channel sf_film_channel(const sf_film *f, size_t index) {
    const size_t w = f->width;
    const sf_channel channels[] = {
        {"R", SF_CHANNEL_FLOAT32, f->color.data(), 12, 12 * w},
        {"G", SF_CHANNEL_FLOAT32, f->color.data() + 1, 12, 12 * w},
        {"B", SF_CHANNEL_FLOAT32, f->color.data() + 2, 12, 12 * w},
        {"A", SF_CHANNEL_FLOAT32, f->alpha.data(), 4, 4 * w},
        {"samples", SF_CHANNEL_UINT32, f->samples.data(), 4, 4 * w},
        {"half_width", SF_CHANNEL_FLOAT32, f->half_width.data(), 4, 4 * w},
        {"stop_reason", SF_CHANNEL_UINT8, f->stop_reason.data(), 1, w},
    };
    return channels[index];
}
size_t sf_film_attribute_count(const sf_film *) { return 2; }
sf_attribute sf_film_attribute(const sf_film *, size_t index) {
    return index == 0 ? sf_attribute{"seed", "18446744073709551615"} : sf_attribute{"relative_tolerance", "0.01"};
}

namespace {

/* Of this thread's allocations of 64 kB and more, how many still succeed; negative: all do. Lack
 * of smaller ones cannot be tested: OpenImageIO 2.4 allocates in functions that must not throw. */
constexpr size_t large_bytes = 65536;
thread_local long allocations_left = -1;

const std::string folder = "image_test";

sf_film make_film(uint32_t width, uint32_t height) {
    const size_t n = size_t{width} * height;
    sf_film film{width,
                 height,
                 std::vector<float>(3 * n),
                 std::vector<float>(n),
                 std::vector<float>(n),
                 std::vector<uint32_t>(n),
                 std::vector<uint8_t>(n)};
    for (size_t i = 0; i < n; ++i) {
        for (size_t c = 0; c < 3; ++c)
            film.color[3 * i + c] = static_cast<float>((7 * i + 13 * c) % 1000) / 900 - 0.01f;
        film.alpha[i] = static_cast<float>(i) / static_cast<float>(n);
        film.samples[i] = static_cast<uint32_t>((i * 9973) % ((1u << 24) + 1));
        film.half_width[i] = 1e-3f * static_cast<float>(i);
        film.stop_reason[i] = static_cast<uint8_t>(i % 6);
    }
    film.color[0] = std::numeric_limits<float>::quiet_NaN();
    film.color[1] = -std::numeric_limits<float>::infinity();
    film.color[2] = film.half_width[0] = std::numeric_limits<float>::infinity();
    return film;
}

std::set<std::string> list_folder() {
    std::set<std::string> names;
    DIR *directory = opendir(folder.c_str());
    assert_non_null(directory);
    while (const dirent *entry = readdir(directory)) names.insert(entry->d_name);
    closedir(directory);
    names.erase(".");
    names.erase("..");
    return names;
}

std::string read_text(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

int empty_folder(void **) { return std::system(("rm -rf " + folder + " && mkdir " + folder).c_str()); }

void test_exr_returns_every_channel_bit_for_bit(void **) {
    const uint32_t width = 37, height = 71; /* neither a multiple of the rows written at a time */
    const sf_film film = make_film(width, height);
    const std::string path = folder + "/a.EXR";
    sf_error error{};
    assert_int_equal(sf_image_write(&film, path.c_str(), &error), SF_STATUS_OK);

    const auto input = OIIO::ImageInput::open(path);
    assert_non_null(input.get());
    const OIIO::ImageSpec spec = input->spec();
    assert_int_equal(spec.width, width);
    assert_int_equal(spec.height, height);
    assert_int_equal(spec.nchannels, 7);
    assert_int_equal(spec.alpha_channel, 3);
    assert_true(spec.format == OIIO::TypeDesc::FLOAT);
    assert_string_equal(spec.get_string_attribute("sunfleck:seed").c_str(), "18446744073709551615");
    assert_string_equal(spec.get_string_attribute("sunfleck:relative_tolerance").c_str(), "0.01");

    std::vector<float> pixels(size_t{width} * height * 7);
    assert_true(input->read_image(0, 0, 0, 7, OIIO::TypeDesc::FLOAT, pixels.data()));
    for (size_t i = 0; i < film.samples.size(); ++i) {
        const auto expect = [&](const char *name, float value) {
            const float got = pixels[7 * i + static_cast<size_t>(spec.channelindex(name))];
            assert_memory_equal(&got, &value, sizeof value);
        };
        expect("R", film.color[3 * i]);
        expect("G", film.color[3 * i + 1]);
        expect("B", film.color[3 * i + 2]);
        expect("A", film.alpha[i]);
        expect("samples", static_cast<float>(film.samples[i]));
        expect("half_width", film.half_width[i]);
        expect("stop_reason", static_cast<float>(film.stop_reason[i]));
    }
}

void test_png_holds_the_nearest_srgb_codes(void **) {
    const uint32_t width = 61, height = 53;
    const sf_film film = make_film(width, height);
    const std::string path = folder + "/a.png";
    sf_error error{};
    assert_int_equal(sf_image_write(&film, path.c_str(), &error), SF_STATUS_OK);

    const auto input = OIIO::ImageInput::open(path);
    assert_non_null(input.get());
    assert_int_equal(input->spec().nchannels, 3);
    assert_true(input->spec().format == OIIO::TypeDesc::UINT8);
    assert_string_equal(input->spec().get_string_attribute("oiio:ColorSpace").c_str(), "sRGB");
    std::vector<uint8_t> codes(film.color.size());
    assert_true(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, codes.data()));

    /* NaN, -inf and +inf; then IEC 61966-2-1 in double, away from ties by the float's error. */
    assert_int_equal(codes[0], 0);
    assert_int_equal(codes[1], 0);
    assert_int_equal(codes[2], 255);
    for (size_t i = 3; i < codes.size(); ++i) {
        const double v = std::fmin(std::fmax(film.color[i], 0.0), 1.0);
        const double exact = 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
        assert_true(std::fabs(codes[i] - exact) < 0.5 + 1e-4);
    }
}

void test_bad_arguments_are_refused_with_a_message(void **) {
    const sf_film film = make_film(3, 2);
    sf_error error{};
    assert_int_equal(sf_image_write(nullptr, "a.exr", &error), SF_STATUS_INVALID_VALUE);
    assert_int_equal(sf_image_write(&film, nullptr, &error), SF_STATUS_INVALID_VALUE);
    for (const char *name : {"", "a", "a.jpg", "a.exr.", "exr", "a.png/"}) {
        const std::string path = folder + "/" + name;
        assert_int_equal(sf_image_write(&film, path.c_str(), &error), SF_STATUS_INVALID_VALUE);
        assert_int_equal(error.status, SF_STATUS_INVALID_VALUE);
        assert_non_null(std::strstr(error.message, path.c_str()));
        assert_non_null(std::strstr(error.message, ".exr or .png"));
    }
    assert_int_equal(sf_image_write(&film, "a.jpg", nullptr), SF_STATUS_INVALID_VALUE);
    assert_true(list_folder().empty());
}

void test_a_path_that_cannot_be_written_is_an_io_error(void **) {
    const sf_film film = make_film(3, 2);
    sf_error error{};
    const std::string directory = folder + "/b.exr";
    assert_int_equal(std::system(("mkdir " + directory).c_str()), 0);
    for (const std::string &path : {folder + "/missing/a.exr", directory}) {
        assert_int_equal(sf_image_write(&film, path.c_str(), &error), SF_STATUS_IO);
        assert_non_null(std::strstr(error.message, path.c_str()));
    }
    assert_true(list_folder() == std::set<std::string>{"b.exr"});
}

/* The link stays one, and what it points to is replaced. */
void test_a_symbolic_link_is_followed(void **) {
    const sf_film film = make_film(3, 2);
    std::ofstream(folder + "/real.exr") << "what was there";
    assert_int_equal(symlink("real.exr", (folder + "/link.exr").c_str()), 0);
    assert_int_equal(sf_image_write(&film, (folder + "/link.exr").c_str(), nullptr), SF_STATUS_OK);
    std::array<char, 16> target{};
    assert_int_equal(readlink((folder + "/link.exr").c_str(), target.data(), target.size()), 8);
    const auto input = OIIO::ImageInput::open(folder + "/real.exr");
    assert_non_null(input.get());
    assert_string_equal(input->spec().get_string_attribute("Software").c_str(), "sunfleck");
    assert_string_equal(input->spec().get_string_attribute("oiio:ColorSpace").c_str(), "Linear");
    assert_true((list_folder() == std::set<std::string>{"link.exr", "real.exr"}));
}

/* A limit on file size stands for a full disk: every write past it fails. */
void test_a_full_disk_leaves_the_old_file_and_nothing_beside(void **) {
    const sf_film film = make_film(256, 256);
    rlimit old_limit;
    getrlimit(RLIMIT_FSIZE, &old_limit);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    for (const char *name : {"/a.exr", "/a.png"}) {
        const std::string path = folder + name;
        std::ofstream(path) << "what was there";
        for (const rlim_t limit : {0, 100, 1000, 1900}) { /* the PNG comes to 2 kB */
            const rlimit small = {limit, old_limit.rlim_max};
            setrlimit(RLIMIT_FSIZE, &small);
            sf_error error{};
            const sf_status status = sf_image_write(&film, path.c_str(), &error);
            setrlimit(RLIMIT_FSIZE, &old_limit);
            assert_int_equal(status, SF_STATUS_IO);
            assert_string_equal(read_text(path).c_str(), "what was there");
        }
    }
    std::signal(SIGXFSZ, old_handler);
    assert_true((list_folder() == std::set<std::string>{"a.exr", "a.png"}));
}

/* Fails the large allocations from the n-th on, for n = 0, 1, … until it gets by. */
void test_failing_allocations_become_a_status(void **) {
    const sf_film film = make_film(1024, 64);
    for (const char *name : {"/c.exr", "/c.png"}) {
        const std::string path = folder + name;
        sf_status status = SF_STATUS_OUT_OF_MEMORY;
        bool refused = false;
        for (long n = 0; status != SF_STATUS_OK; ++n) {
            assert_true(n < 1000);
            sf_error error{};
            allocations_left = n;
            status = sf_image_write(&film, path.c_str(), &error);
            allocations_left = -1;
            if (status != SF_STATUS_OK) assert_true(list_folder().empty());
            refused |= status == SF_STATUS_OUT_OF_MEMORY; /* OpenImageIO's own are reported by it as IO */
        }
        assert_true(refused);
        assert_int_equal(unlink(path.c_str()), 0);
    }
    assert_true(list_folder().empty());
}

}  // namespace

void *operator new(size_t bytes) {
    if (bytes >= large_bytes && allocations_left == 0) throw std::bad_alloc();
    if (bytes >= large_bytes && allocations_left > 0) --allocations_left;
    if (void *memory = std::malloc(bytes ? bytes : 1)) return memory;
    throw std::bad_alloc();
}
void operator delete(void *memory) noexcept { std::free(memory); }
void operator delete(void *memory, size_t) noexcept { std::free(memory); }

int main() {
    const CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_exr_returns_every_channel_bit_for_bit, empty_folder),
        cmocka_unit_test_setup(test_png_holds_the_nearest_srgb_codes, empty_folder),
        cmocka_unit_test_setup(test_bad_arguments_are_refused_with_a_message, empty_folder),
        cmocka_unit_test_setup(test_a_path_that_cannot_be_written_is_an_io_error, empty_folder),
        cmocka_unit_test_setup(test_a_symbolic_link_is_followed, empty_folder),
        cmocka_unit_test_setup(test_a_full_disk_leaves_the_old_file_and_nothing_beside, empty_folder),
        cmocka_unit_test_setup(test_failing_allocations_become_a_status, empty_folder),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
