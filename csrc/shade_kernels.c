// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

#include "shade_kernels.h"

#include <math.h>
#include <string.h>

#include "lanes.h"
#include "sunfleck/mapping.h"

#define SHADOW_BINS 64 /* 4 quarters of a cell x 4 x 4 cells of the light */

/* Rays in whole packets. */
static uint32_t whole(uint32_t count) { return (count + SF_LANES - 1) / SF_LANES * SF_LANES; }

/* ---- camera ---- */

static void apply_filter(sf_batch *b, sf_pixel_filter filter) {
    uint32_t n = b->block_count * SF_LANES;
    float place[2];
    if (filter == SF_PIXEL_FILTER_TENT)
        for (uint32_t i = 0; i < n; ++i) {
            sf_pixel_tent_sample(b->coordinate[0][i], b->coordinate[1][i], place);
            b->coordinate[0][i] = place[0];
            b->coordinate[1][i] = place[1];
        }
    else if (filter == SF_PIXEL_FILTER_GAUSSIAN)
        for (uint32_t i = 0; i < n; ++i) {
            sf_pixel_gaussian_sample(b->coordinate[0][i], b->coordinate[1][i], 0.4f, place);
            b->coordinate[0][i] = place[0];
            b->coordinate[1][i] = place[1];
        }
}

/* Directions through the pixels: forward + x right + y up, before they are normalized. */
static void aim(sf_batch *b, const sf_camera_frame *camera) {
    for (uint32_t block = 0; block < b->block_count; ++block) {
        float left = (float)b->blocks[block].x - camera->half_width,
              top = camera->half_height - (float)b->blocks[block].y;
        for (uint32_t i = block * SF_LANES; i < (block + 1) * SF_LANES; ++i) {
            float x = (left + b->coordinate[0][i]) * camera->pixel, y = (top - b->coordinate[1][i]) * camera->pixel;
            for (int c = 0; c < 3; ++c)
                b->direction[c][i] = camera->forward[c] + x * camera->right[c] + y * camera->up[c];
        }
    }
}

static void leave_pinhole(sf_batch *b, const sf_camera_frame *camera) {
    for (uint32_t i = 0; i < b->block_count * SF_LANES; ++i)
        for (int c = 0; c < 3; ++c) b->origin[c][i] = camera->position[c];
}

/* A point of the lens, and from it to where the pinhole's ray meets the focal plane. */
static void leave_lens(sf_batch *b, const sf_camera_frame *camera, float (*lens)[SF_PATHS]) {
    for (uint32_t i = 0; i < b->block_count * SF_LANES; ++i) {
        float disk[2];
        sf_disk_concentric_sample(lens[0][i], lens[1][i], disk);
        float x = disk[0] * camera->aperture_radius, y = disk[1] * camera->aperture_radius;
        for (int c = 0; c < 3; ++c) {
            float offset = x * camera->right[c] + y * camera->up[c];
            b->origin[c][i] = camera->position[c] + offset;
            b->direction[c][i] = camera->focus_distance * b->direction[c][i] - offset;
        }
    }
}

static void normalize_directions(sf_batch *b) {
    for (uint32_t i = 0; i < b->block_count * SF_LANES; ++i) {
        float x = b->direction[0][i], y = b->direction[1][i], z = b->direction[2][i];
        float scale = 1 / sqrtf(x * x + y * y + z * z);
        b->direction[0][i] = x * scale;
        b->direction[1][i] = y * scale;
        b->direction[2][i] = z * scale;
    }
}

static void camera(sf_batch *b, const sf_camera_frame *frame, sf_pixel_filter filter, float (*lens)[SF_PATHS]) {
    apply_filter(b, filter);
    aim(b, frame);
    if (lens)
        leave_lens(b, frame, lens);
    else
        leave_pinhole(b, frame);
    normalize_directions(b);
}

/* ---- what the meshes hold ---- */

/* Reads `columns` columns of the mesh table, one value a ray; packets that hit a single mesh,
 * as most do, are filled without gathering. */
static void look_up(const sf_mesh_table *table, int first, int columns, const uint32_t *mesh, uint32_t count,
                    float (*SF_RESTRICT out)[SF_PATHS]) {
    for (uint32_t i = 0; i < count; i += SF_LANES) {
        uint32_t different = 0;
        for (uint32_t l = 0; l < SF_LANES; ++l) different |= mesh[i + l] ^ mesh[i];
        for (int c = 0; c < columns; ++c) {
            const float *column = table->columns[first + c];
            if (different)
                for (uint32_t l = 0; l < SF_LANES; ++l) out[c][i + l] = column[mesh[i + l]];
            else {
                float value = column[mesh[i]];
                for (uint32_t l = 0; l < SF_LANES; ++l) out[c][i + l] = value;
            }
        }
    }
}

/* 1 where the ray comes from the side that the geometric normal points to, else 0. */
static inline float front_side(const sf_batch *b, uint32_t i) {
    float along = b->direction[0][i] * b->hit_normal[0][i] + b->direction[1][i] * b->hit_normal[1][i] +
                  b->direction[2][i] * b->hit_normal[2][i];
    return along < 0 ? 1.0f : 0.0f;
}

static void first_radiance(sf_batch *b, const sf_scene *scene) {
    uint32_t n = b->block_count * SF_LANES, miss = scene->mesh_table.miss;
    for (uint32_t i = 0; i < n; ++i) b->covered[i] = b->mesh[i] == miss ? 0.0f : 1.0f;
    if (sf_plan_has(&scene->plan, SF_STAGE_EMISSION)) {
        look_up(&scene->mesh_table, SF_MESH_EMISSION_R, 3, b->mesh, n, b->emission);
        for (uint32_t i = 0; i < n; ++i) {
            float front = front_side(b, i);
            for (int c = 0; c < 3; ++c) b->radiance[c][i] = b->covered[i] > 0 ? front * b->emission[c][i] : 0.0f;
        }
    } else
        for (int c = 0; c < 3; ++c) memset(b->radiance[c], 0, n * sizeof(float));
    if (sf_plan_has(&scene->plan, SF_STAGE_MISS))
        for (uint32_t i = 0; i < n; ++i)
            for (int c = 0; c < 3; ++c) b->radiance[c][i] += b->covered[i] > 0 ? 0.0f : scene->background[c];
}

/* The power heuristic with exponent 2 (Veach 1997, eq. 9.11), pdf^2 / (pdf^2 + other^2), by the
 * ratio: the squares of densities by solid angle leave the floats' range in large scenes. */
static inline float power_weight(float pdf, float other) {
    float ratio = other / pdf;
    return 1 / (1 + ratio * ratio);
}

static void later_emission(sf_batch *b, const sf_scene *scene, uint32_t n) {
    look_up(&scene->mesh_table, SF_MESH_EMISSION_R, 3, b->mesh, n, b->emission);
    look_up(&scene->mesh_table, SF_MESH_LIGHT_PDF, 1, b->mesh, n, &b->light_pdf);
    for (uint32_t i = 0; i < n; ++i) {
        float nx = b->hit_normal[0][i], ny = b->hit_normal[1][i], nz = b->hit_normal[2][i];
        float along = -(b->direction[0][i] * nx + b->direction[1][i] * ny + b->direction[2][i] * nz);
        float cosine = along / sqrtf(nx * nx + ny * ny + nz * nz);
        /* Density by area to density by solid angle: times distance^2 / cosine. */
        float light_pdf = b->light_pdf[i] * b->distance[i] * b->distance[i] / cosine;
        float weight = power_weight(b->pdf[i], light_pdf);
        for (int c = 0; c < 3; ++c)
            b->emission[c][i] =
                (along > 0) & (b->light_pdf[i] > 0) ? b->throughput[c][i] * b->emission[c][i] * weight : 0.0f;
    }
}

static void later_radiance(sf_batch *b, const sf_scene *scene, uint32_t count) {
    uint32_t n = whole(count), miss = scene->mesh_table.miss;
    bool emission = sf_plan_has(&scene->plan, SF_STAGE_EMISSION), background = sf_plan_has(&scene->plan, SF_STAGE_MISS);
    if (!emission && !background) return;
    if (emission)
        later_emission(b, scene, n);
    else
        for (int c = 0; c < 3; ++c) memset(b->emission[c], 0, n * sizeof(float));
    if (background)
        for (uint32_t i = 0; i < n; ++i)
            for (int c = 0; c < 3; ++c)
                b->emission[c][i] = b->mesh[i] == miss ? b->throughput[c][i] * scene->background[c] : b->emission[c][i];
    for (int c = 0; c < 3; ++c) {
        SF_INDEPENDENT
        for (uint32_t i = 0; i < count; ++i) b->radiance[c][b->path[i]] += b->emission[c][i];
    }
}

/* ---- vertices ---- */

/* Puts the vertex where the ray hit, with its normal on the ray's side, and moves it off the
 * surface along that normal by 2^-18 of what its coordinates were computed from: |origin| and
 * the distance. Their rounding, and that of Embree's own distance, is some 2^-22 of it. */
static inline void place_vertex(sf_batch *b, uint32_t i) {
    float nx = b->hit_normal[0][i], ny = b->hit_normal[1][i], nz = b->hit_normal[2][i];
    float dx = b->direction[0][i], dy = b->direction[1][i], dz = b->direction[2][i];
    float ox = b->origin[0][i], oy = b->origin[1][i], oz = b->origin[2][i], t = b->distance[i];
    float along = dx * nx + dy * ny + dz * nz, length = 1 / sqrtf(nx * nx + ny * ny + nz * nz);
    float turn = along > 0 ? -length : length;
    nx *= turn;
    ny *= turn;
    nz *= turn;
    float ax = fabsf(ox), ay = fabsf(oy), az = fabsf(oz);
    float largest = ax > ay ? ax : ay;
    largest = largest > az ? largest : az;
    float lift = 0x1p-18f * (largest + t);
    b->point[0][i] = ox + t * dx + lift * nx;
    b->point[1][i] = oy + t * dy + lift * ny;
    b->point[2][i] = oz + t * dz + lift * nz;
    b->normal[0][i] = nx;
    b->normal[1][i] = ny;
    b->normal[2][i] = nz;
}

static void place_vertices(sf_batch *b, const sf_scene *scene, uint32_t n) {
    look_up(&scene->mesh_table, SF_MESH_ALBEDO_R, 3, b->mesh, n, b->albedo);
    for (uint32_t i = 0; i < n; ++i) place_vertex(b, i);
}

static void first_vertex(sf_batch *b, const sf_scene *scene) {
    uint32_t n = b->block_count * SF_LANES;
    place_vertices(b, scene, n);
    for (uint32_t i = 0; i < n; ++i) {
        float r = b->albedo[0][i], g = b->albedo[1][i], blue = b->albedo[2][i];
        b->throughput[0][i] = r;
        b->throughput[1][i] = g;
        b->throughput[2][i] = blue;
        b->path[i] = i;
        b->alive[i] = r + g + blue > 0;
    }
}

static void later_vertex(sf_batch *b, const sf_scene *scene, uint32_t count) {
    uint32_t n = whole(count);
    place_vertices(b, scene, n);
    for (uint32_t i = 0; i < n; ++i) {
        float r = b->throughput[0][i] *= b->albedo[0][i];
        float g = b->throughput[1][i] *= b->albedo[1][i];
        float blue = b->throughput[2][i] *= b->albedo[2][i];
        b->alive[i] = r + g + blue > 0;
    }
}

static uint32_t list_alive(sf_batch *b, uint32_t count) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        b->order[kept] = i;
        kept += b->alive[i];
    }
    return kept;
}

/* order[i] >= i, so that the list can be moved to the front within its own array. */
static void move_floats(sf_batch *b, float *SF_RESTRICT array, uint32_t kept) {
    for (uint32_t i = 0; i < kept; ++i) b->gather[i] = array[b->order[i]];
    memcpy(array, b->gather, kept * sizeof *array);
}

static uint32_t compact(sf_batch *b, uint32_t count) {
    uint32_t kept = list_alive(b, count);
    if (kept == count) return kept;
    for (int c = 0; c < 3; ++c) {
        move_floats(b, b->point[c], kept);
        move_floats(b, b->normal[c], kept);
        move_floats(b, b->throughput[c], kept);
    }
    for (uint32_t i = 0; i < kept; ++i) b->path[i] = b->path[b->order[i]];
    return kept;
}

/* ---- light ---- */

/* The coordinates of the living paths; they are where they belong while all of them live. */
static float (*by_ray(sf_batch *b, uint32_t count, int coordinates)) [SF_PATHS] {
    if (count == b->block_count * SF_LANES) return b->coordinate;
    for (int c = 0; c < coordinates; ++c)
        for (uint32_t i = 0; i < count; ++i) b->coordinate_by_ray[c][i] = b->coordinate[c][b->path[i]];
    return b->coordinate_by_ray;
}

/* The pieces that the 16 rays of a packet were given, field by field. */
typedef struct light_lanes {
    SF_ALIGNED(float) field[SF_LIGHT_SAMPLED][SF_LANES];
} light_lanes;

/* What connects vertex first + l to a point of its light piece. */
static inline void connect(sf_batch *b, const light_lanes *lights, uint32_t first, uint32_t l, float s, float t,
                           bool weigh) {
    const float (*field)[SF_LANES] = lights->field;
    uint32_t i = first + l;
    /* On a triangle the lecture's map, on a parallelogram the unit square itself. */
    float root = sqrtf(s), rectangle = field[SF_LIGHT_RECTANGLE][l];
    float alpha = rectangle > 0 ? s : root * t, beta = rectangle > 0 ? t : 1 - root;
    float to[3], normal[3], lifted[3];
    for (int c = 0; c < 3; ++c) {
        lifted[c] = field[SF_LIGHT_ORIGIN_X + c][l] + alpha * field[SF_LIGHT_EDGE1_X + c][l] +
                    beta * field[SF_LIGHT_EDGE2_X + c][l];
        normal[c] = field[SF_LIGHT_NORMAL_X + c][l];
        to[c] = lifted[c] - b->point[c][i];
    }
    /* Move the light point off its surface too, as the vertex was, so that the ray ends before it. */
    float ax = fabsf(lifted[0]), ay = fabsf(lifted[1]), az = fabsf(lifted[2]);
    float largest = ax > ay ? ax : ay;
    largest = largest > az ? largest : az;
    float square = to[0] * to[0] + to[1] * to[1] + to[2] * to[2], distance = sqrtf(square), inverse = 1 / square;
    float lift = 0x1p-18f * (largest + distance);
    float cos_surface = to[0] * b->normal[0][i] + to[1] * b->normal[1][i] + to[2] * b->normal[2][i];
    float cos_light = -(to[0] * normal[0] + to[1] * normal[1] + to[2] * normal[2]);
    bool sees = (cos_surface > 0) & (cos_light > 0);
    /* cos cos / distance^2, each cosine still times the distance. */
    float geometry = sees ? cos_surface * inverse * (cos_light * inverse) : 0.0f;
    if (weigh) {
        float surface_pdf = cos_surface * (1.0f / SF_PI_F) / distance;
        float light_pdf = field[SF_LIGHT_PDF][l] * square * distance / cos_light;
        geometry = sees ? geometry * power_weight(light_pdf, surface_pdf) : 0.0f;
    }
    float sum = 0;
    for (int c = 0; c < 3; ++c) {
        b->to_light[c][i] = to[c] + lift * normal[c];
        float value = b->throughput[c][i] * field[SF_LIGHT_WEIGHT_R + c][l] * geometry;
        b->contribution[c][i] = value;
        sum += value;
    }
    b->alive[i] = sum > 0;
}

/* The quarter of the cell and the cell of the light: rays of a bin start close to each other and
 * end close to each other. */
static inline uint32_t shadow_bin(uint32_t path, float s, float t) {
    return path / (SF_PATHS / 4) * 16 + (uint32_t)(int)(s * 4) * 4 + (uint32_t)(int)(t * 4);
}

static void connect_packet(sf_batch *b, const light_lanes *lights, float (*u)[SF_PATHS], uint32_t first, bool weigh) {
    SF_ALIGNED(float) s[SF_LANES], t[SF_LANES]; /* apart from what is written below */
    memcpy(s, u[0] + first, sizeof s);
    memcpy(t, u[1] + first, sizeof t);
    if (weigh)
        for (uint32_t l = 0; l < SF_LANES; ++l) connect(b, lights, first, l, s[l], t[l], true);
    else
        for (uint32_t l = 0; l < SF_LANES; ++l) connect(b, lights, first, l, s[l], t[l], false);
    for (uint32_t l = 0; l < SF_LANES; ++l) b->bin[first + l] = shadow_bin(b->path[first + l], s[l], t[l]);
}

static inline void give_piece(light_lanes *lights, uint32_t l, const float piece[SF_LIGHT_FIELDS]) {
    for (int f = 0; f < SF_LIGHT_SAMPLED; ++f) lights->field[f][l] = piece[f];
}

/* Draws a piece from the alias table: the integer part picks a column, the rest decides. */
static inline uint32_t choose_piece(const sf_light_table *lights, float u) {
    uint32_t last = (uint32_t)lights->count - 1;
    float place = u * (float)lights->count;
    uint32_t row = (uint32_t)place;
    row = row < last ? row : last;
    return place - (float)row < lights->pieces[row][SF_LIGHT_KEEP] ? row : lights->alias[row];
}

static void light(sf_batch *b, const sf_scene *scene, uint32_t count, bool weigh) {
    const sf_light_table *lights = &scene->lights;
    bool several = lights->count > 1;
    float (*u)[SF_PATHS] = by_ray(b, count, several ? 3 : 2);
    light_lanes lanes;
    for (uint32_t l = 0; l < SF_LANES; ++l) give_piece(&lanes, l, lights->pieces[0]);
    for (uint32_t first = 0; first < count; first += SF_LANES) {
        if (several) /* lanes past the end hold no place in the table: they keep what they have */
            for (uint32_t l = 0; l < SF_LANES && first + l < count; ++l)
                give_piece(&lanes, l, lights->pieces[choose_piece(lights, u[2][first + l])]);
        connect_packet(b, &lanes, u, first, weigh);
    }
}

/* A counting sort. */
static uint32_t sort_shadow_rays(sf_batch *b, uint32_t count) {
    uint32_t place[SHADOW_BINS + 1] = {0};
    for (uint32_t i = 0; i < count; ++i) place[b->bin[i] + 1] += b->alive[i];
    for (uint32_t bin = 0; bin < SHADOW_BINS; ++bin) place[bin + 1] += place[bin];
    for (uint32_t i = 0; i < count; ++i)
        if (b->alive[i]) b->order[place[b->bin[i]]++] = i;
    return place[SHADOW_BINS - 1];
}

/* A ray that was not alive was not traced, and its contribution may be no number. */
static inline float arriving(const sf_batch *b, int c, uint32_t i) {
    return b->alive[i] && b->arrives[i] > 0 ? b->contribution[c][i] : 0.0f;
}

static void add_light(sf_batch *b, uint32_t count) {
    bool in_place = count == b->block_count * SF_LANES; /* all paths live: path[i] = i */
    for (int c = 0; c < 3; ++c)
        if (in_place)
            for (uint32_t i = 0; i < count; ++i) b->radiance[c][i] += arriving(b, c, i);
        else {
            SF_INDEPENDENT
            for (uint32_t i = 0; i < count; ++i) b->radiance[c][b->path[i]] += arriving(b, c, i);
        }
}

/* ---- surface ---- */

static void surface(sf_batch *b, uint32_t count) {
    float (*u)[SF_PATHS] = by_ray(b, count, 2);
    for (uint32_t i = 0; i < whole(count); ++i) {
        float normal[3] = {b->normal[0][i], b->normal[1][i], b->normal[2][i]};
        float local[3], tangent[3], bitangent[3], world[3];
        sf_cosine_hemisphere_sample(u[0][i], u[1][i], local);
        sf_frame_from_normal(normal, tangent, bitangent);
        sf_frame_to_world(tangent, bitangent, normal, local, world);
        b->pdf[i] = local[2] * (1.0f / SF_PI_F);
        for (int c = 0; c < 3; ++c) {
            b->direction[c][i] = world[c];
            b->origin[c][i] = b->point[c][i];
        }
    }
}

/* ---- film ---- */

/* keep[l] = 1 where the sample was asked for and is finite, else 0. */
static inline void choose_samples(const sf_batch *b, uint32_t first, uint32_t wanted, float keep[SF_LANES]) {
    SF_ROLLED
    for (uint32_t l = 0; l < SF_LANES; ++l) {
        float sum = b->radiance[0][first + l] + b->radiance[1][first + l] + b->radiance[2][first + l];
        float asked = (float)(int)(wanted >> l & 1u);
        keep[l] = fabsf(sum) <= 3.4e38f ? asked : 0.0f;
    }
}

static void gather_block(const sf_batch *b, uint32_t block, sf_block_statistics *out) {
    uint32_t first = block * SF_LANES, wanted = b->blocks[block].active;
    SF_ALIGNED(float) keep[SF_LANES];
    SF_ALIGNED(double) value[SF_LANES], squares[SF_LANES] = {0};
    choose_samples(b, first, wanted, keep);
    SF_ROLLED
    for (int l = 0; l < SF_LANES; ++l) value[l] = (double)keep[l];
    double count = sf_sum16(value), inverse = count > 0 ? 1 / count : 0;
    for (int c = 0; c < 3; ++c) {
        const float *radiance = b->radiance[c] + first;
        SF_ROLLED
        for (int l = 0; l < SF_LANES; ++l) value[l] = (double)(keep[l] > 0 ? radiance[l] : 0.0f);
        double mean = out->moments.mean[c] = sf_sum16(value) * inverse;
        SF_ROLLED
        for (int l = 0; l < SF_LANES; ++l) {
            double off = (double)keep[l] * (value[l] - mean);
            squares[l] += off * off;
        }
    }
    SF_ROLLED
    for (int l = 0; l < SF_LANES; ++l) value[l] = (double)(keep[l] * b->covered[first + (uint32_t)l]);
    out->hits = (uint32_t)(int)sf_sum16(value);
    out->moments.m2 = sf_sum16(squares);
    out->moments.count = (uint64_t)(int)count;
    out->moments.nonfinite = (uint64_t)sf_count_bits(wanted) - out->moments.count;
}

static void gather_statistics(sf_batch *b) {
    for (uint32_t block = 0; block < b->block_count; ++block) gather_block(b, block, b->statistics + block);
}

const sf_shade_kernels SF_AT_LEVEL(sf_shade_kernels) = {
    camera, first_radiance,   later_radiance, first_vertex, later_vertex,     compact,
    light,  sort_shadow_rays, add_light,      surface,      gather_statistics};
