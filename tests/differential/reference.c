// SPDX-FileCopyrightText: 2026 The Sunfleck developers
// SPDX-License-Identifier: Apache-2.0

/* A plain path tracer, the second opinion that tests/differential compares the renderer with.
 *
 * It shares no line with the library, and is made in other ways where there is another: scalar, in double
 * precision, every ray against every primitive, one path after the other. Every vertex draws a point on every light
 * and keeps one of them in proportion to what it would bring, so that no light is chosen before it is known (Talbot,
 * Cline & Egbert 2005, "Importance Resampling for Global Illumination"); the balance heuristic weighs light against
 * surface sampling, light by light (Veach 1997); there is no roulette, and pixel filters are tables.
 *
 * scene_file.py fills the structures by ctypes: their layout is the same there. */
#include <math.h>
#include <stdint.h>

#include "reference_filters.h"

typedef struct vec {
    double x, y, z;
} vec;

enum { DIFFUSE, MIRROR, DIELECTRIC, CONDUCTOR, FOG };
typedef struct material {
    double kind, ior, alpha; /* alpha: GGX's, 0 where smooth */
    double albedo[3], emission[3];
} material;

enum { TRIANGLE, SPHERE, DISK };
typedef struct primitive {
    double kind, material;
    vec a, b, c; /* a triangle's corner and two edges; centre (radius, 0, 0); centre, normal, (radius, 0, 0) */
    vec normal;  /* of unit length; not a sphere's */
    double area;
} primitive;

typedef struct sun {
    vec axis;                  /* of unit length */
    double angle, radiance[3]; /* angle 0: one direction, and `radiance` is irradiance */
} sun;

typedef struct scene {
    const material *materials;
    const primitive *primitives;
    const sun *suns;
    const double *sky; /* sky_height rows of sky_width RGB; NULL: none */
    int64_t primitive_count, sun_count, sky_width, sky_height;
    vec sky_up, sky_front, sky_left; /* longitude 0 and 90 degrees */
    double background[3];
    double scattering, absorption, g;
    vec eye, forward, right, up;
    double pixel, lens, focus; /* size of a pixel at distance 1, radius of the lens, distance of the focal plane */
    int64_t width, height, filter, max_bounces;
    double size; /* of the scene, which self-intersection is judged by */
} scene;

/* ---- vectors and random numbers ---- */

static vec make(double x, double y, double z) { return (vec){x, y, z}; }
static vec add(vec a, vec b) { return make(a.x + b.x, a.y + b.y, a.z + b.z); }
static vec sub(vec a, vec b) { return make(a.x - b.x, a.y - b.y, a.z - b.z); }
static vec times(double s, vec a) { return make(s * a.x, s * a.y, s * a.z); }
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b) { return make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static vec unit(vec a) { return times(1 / sqrt(dot(a, a)), a); }
static double luminance(const double c[3]) { return c[0] + c[1] + c[2]; }

/* Two directions at right angles to n and to each other. */
static void frame(vec n, vec *s, vec *t) {
    *s = unit(cross(fabs(n.x) < 0.5 ? make(1, 0, 0) : make(0, 1, 0), n));
    *t = cross(n, *s);
}
static vec to_world(vec n, vec local) {
    vec s, t;
    frame(n, &s, &t);
    return add(add(times(local.x, s), times(local.y, t)), times(local.z, n));
}
static vec to_local(vec n, vec world) {
    vec s, t;
    frame(n, &s, &t);
    return make(dot(s, world), dot(t, world), dot(n, world));
}

/* xorshift128+ (Vigna 2017): of its state of 128 bits, both words are filled by a mix of the seed. */
typedef struct random {
    uint64_t a, b;
} random;
static double draw(random *r) {
    uint64_t s = r->a, t = r->b, sum = s + t;
    r->a = t;
    s ^= s << 23;
    r->b = s ^ t ^ (s >> 18) ^ (t >> 5);
    return (double)(sum >> 11) * 0x1p-53;
}
static uint64_t mix(uint64_t x) { /* the finalizer of MurmurHash3 */
    x = (x ^ (x >> 33)) * 0xff51afd7ed558ccdu;
    x = (x ^ (x >> 33)) * 0xc4ceb9fe1a85ec53u;
    return x ^ (x >> 33);
}
static vec on_sphere_cap(random *r, double lowest) { /* uniform where z >= lowest */
    double z = lowest + (1 - lowest) * draw(r), ring = sqrt(fmax(0, 1 - z * z)), turn = 2 * PI * draw(r);
    return make(ring * cos(turn), ring * sin(turn), z);
}

/* ---- rays ---- */

/* o + t d = a + u b + v c by Cramer's rule, undivided until the triangle is known to be hit. */
static double hit_triangle(const primitive *p, vec o, vec d, double near) {
    vec off = sub(o, p->a), turn;
    double height = 2 * p->area * dot(off, p->normal), along = -2 * p->area * dot(d, p->normal), u, v;
    if (height * along <= 0) return INFINITY;
    turn = cross(d, off);
    u = along < 0 ? dot(p->c, turn) : -dot(p->c, turn);
    v = along < 0 ? -dot(p->b, turn) : dot(p->b, turn);
    if (u < 0 || v < 0 || u + v > fabs(along)) return INFINITY;
    return height / along > near ? height / along : INFINITY;
}
static double hit_sphere(const primitive *p, vec o, vec d, double near) {
    vec off = sub(o, p->a);
    double b = dot(off, d), radius = p->b.x;
    vec closest = sub(off, times(b, d));
    double left = radius * radius - dot(closest, closest), root = sqrt(fmax(left, 0));
    if (left < 0) return INFINITY;
    return -b - root > near ? -b - root : -b + root > near ? -b + root : INFINITY;
}
static double hit_disk(const primitive *p, vec o, vec d, double near) {
    double along = dot(d, p->normal), t = dot(sub(p->a, o), p->normal) / along;
    vec off = sub(add(o, times(t, d)), p->a);
    return along != 0 && t > near && dot(off, off) <= p->c.x * p->c.x ? t : INFINITY;
}
static double hit(const primitive *p, vec o, vec d, double near) {
    if (p->kind == TRIANGLE) return hit_triangle(p, o, d, near);
    return p->kind == SPHERE ? hit_sphere(p, o, d, near) : hit_disk(p, o, d, near);
}
/* The nearest primitive, -1 for none. */
static int64_t trace(const scene *s, vec o, vec d, double *distance) {
    int64_t best = -1;
    *distance = INFINITY;
    for (int64_t i = 0; i < s->primitive_count; ++i) {
        double t = hit(s->primitives + i, o, d, 1e-9 * s->size);
        if (t < *distance) {
            *distance = t;
            best = i;
        }
    }
    return best;
}
static int blocked(const scene *s, vec o, vec d, double distance) {
    for (int64_t i = 0; i < s->primitive_count; ++i)
        if (hit(s->primitives + i, o, d, 1e-9 * s->size) < distance - 1e-8 * s->size) return 1;
    return 0;
}

/* ---- surfaces and fog: value is the scattering function times the cosine, of radiance ---- */

typedef struct vertex {
    const material *m;
    vec point, normal, w; /* normal on the side the path comes from; w in its frame: where the path comes from */
    double eta;           /* index of refraction beyond the surface over that on w's side */
} vertex;

static double fresnel(double cosine, double eta) { /* Born & Wolf, section 1.5.2 */
    double sine = sqrt(fmax(0, 1 - cosine * cosine)) / eta, beyond = sqrt(fmax(0, 1 - sine * sine));
    double s = (cosine - eta * beyond) / (cosine + eta * beyond), p = (eta * cosine - beyond) / (eta * cosine + beyond);
    return sine >= 1 ? 1 : (s * s + p * p) / 2;
}
static double schlick(double albedo, double cosine) { return albedo + (1 - albedo) * pow(1 - cosine, 5); }

static double ggx(vec h, double alpha) { /* Walter et al. 2007, eq. 33 */
    double cosine2 = h.z * h.z, tan2 = (1 - cosine2) / cosine2, k = alpha * alpha + tan2;
    return h.z > 0 ? alpha * alpha / (PI * cosine2 * cosine2 * k * k) : 0;
}
static double lambda(vec w, double alpha) { /* Heitz 2014, eq. 72 */
    double cosine2 = w.z * w.z;
    return (sqrt(1 + alpha * alpha * (1 - cosine2) / cosine2) - 1) / 2;
}
/* Density of visible normals; Heitz 2014, eq. 16. */
static double visible(vec w, vec h, double alpha) {
    return fmax(0, dot(w, h)) * ggx(h, alpha) / (1 + lambda(w, alpha)) / w.z;
}
/* Heitz 2018, "Sampling the GGX Distribution of Visible Normals", by a projected disk. */
static vec sample_visible(vec w, double alpha, random *r) {
    vec v = unit(make(alpha * w.x, alpha * w.y, w.z)), s, t, h;
    double radius = sqrt(draw(r)), turn = 2 * PI * draw(r), x = radius * cos(turn), y = radius * sin(turn);
    double half = (1 + v.z) / 2;
    s = v.z < 0.9999999 ? unit(cross(make(0, 0, 1), v)) : make(1, 0, 0);
    t = cross(v, s);
    y = (1 - half) * sqrt(fmax(0, 1 - x * x)) + half * y;
    h = add(add(times(x, s), times(y, t)), times(sqrt(fmax(0, 1 - x * x - y * y)), v));
    return unit(make(alpha * h.x, alpha * h.y, fmax(1e-12, h.z)));
}
static vec mirrored(vec w, vec h) { return sub(times(2 * dot(w, h), h), w); }
static vec refracted(vec w, vec h, double eta) {
    double c = dot(w, h);
    return sub(times(c / eta - sqrt(fmax(0, 1 - (1 - c * c) / (eta * eta))), h), times(1 / eta, w));
}

static int smooth(const material *m) {
    return m->kind == MIRROR || (m->kind >= DIELECTRIC && m->kind != FOG && m->alpha == 0);
}

static void conductor(const vertex *x, vec v, double value[3], double *pdf) {
    vec h = unit(add(x->w, v));
    double alpha = x->m->alpha;
    if (v.z <= 0) return;
    double f = ggx(h, alpha) / (1 + lambda(x->w, alpha) + lambda(v, alpha)) / (4 * x->w.z); /* Heitz 2014, eq. 99 */
    for (int c = 0; c < 3; ++c) value[c] = f * schlick(x->m->albedo[c], dot(x->w, h));
    *pdf = visible(x->w, h, alpha) / (4 * dot(x->w, h));
}
static void dielectric(const vertex *x, vec v, double value[3], double *pdf) {
    double eta = x->eta, alpha = x->m->alpha, f;
    vec h = unit(v.z > 0 ? add(x->w, v) : add(x->w, times(eta, v)));
    if (h.z < 0) h = times(-1, h);
    double wh = dot(x->w, h), vh = dot(v, h), share = fresnel(fmax(wh, 0), eta);
    if (wh <= 0 || vh * v.z <= 0) return;
    if (v.z > 0) {
        f = share * ggx(h, alpha) / (1 + lambda(x->w, alpha) + lambda(v, alpha)) / (4 * x->w.z);
        *pdf = share * visible(x->w, h, alpha) / (4 * wh);
    } else { /* Walter et al. 2007, eq. 21 and 17; of radiance, so over eta^2 */
        double masking = 1 / ((1 + lambda(x->w, alpha)) * (1 + lambda(v, alpha)));
        double jacobian = eta * eta * -vh / ((wh + eta * vh) * (wh + eta * vh));
        f = (1 - share) * wh * ggx(h, alpha) * masking * jacobian / x->w.z / (eta * eta);
        *pdf = (1 - share) * visible(x->w, h, alpha) * jacobian;
    }
    for (int c = 0; c < 3; ++c) value[c] = f * (v.z > 0 ? 1 : x->m->albedo[c]);
}
static double phase(double cosine, double g) { /* Henyey & Greenstein 1941 */
    return (1 - g * g) / (4 * PI * pow(1 + g * g - 2 * g * cosine, 1.5));
}
/* Value and density of the local direction v. */
static void scatter(const scene *s, const vertex *x, vec v, double value[3], double *pdf) {
    value[0] = value[1] = value[2] = *pdf = 0;
    if (x->m->kind == CONDUCTOR) conductor(x, v, value, pdf);
    if (x->m->kind == DIELECTRIC) dielectric(x, v, value, pdf);
    if (x->m->kind == DIFFUSE && v.z > 0) {
        *pdf = v.z / PI;
        for (int c = 0; c < 3; ++c) value[c] = x->m->albedo[c] * v.z / PI;
    }
    if (x->m->kind == FOG) { /* the normal is where the path comes from: it travels along -z */
        *pdf = phase(-v.z, s->g);
        for (int c = 0; c < 3; ++c) value[c] = x->m->albedo[c] * *pdf;
    }
}
/* A local direction; `factor` is value over density. The density is infinite where the surface is smooth. */
static vec sample(const scene *s, const vertex *x, random *r, double factor[3], double *pdf) {
    const material *m = x->m;
    vec v, h = make(0, 0, 1);
    if (m->kind == DIFFUSE) {
        double ring = sqrt(draw(r)), turn = 2 * PI * draw(r);
        v = make(ring * cos(turn), ring * sin(turn), sqrt(1 - ring * ring));
    } else if (m->kind == FOG) { /* by rejection, which inverts no formula */
        double most = phase(s->g > 0 ? 1 : -1, s->g);
        do v = on_sphere_cap(r, -1);
        while (draw(r) * most > phase(-v.z, s->g));
    } else {
        if (m->alpha > 0) h = sample_visible(x->w, m->alpha, r);
        int reflects = m->kind != DIELECTRIC || draw(r) < fresnel(fmax(dot(x->w, h), 0), x->eta);
        v = reflects ? mirrored(x->w, h) : refracted(x->w, h, x->eta);
        if (reflects != (v.z > 0)) v.z = 0; /* the wrong side: lost */
    }
    *pdf = INFINITY;
    for (int c = 0; c < 3; ++c) {
        factor[c] = m->kind == CONDUCTOR ? schlick(m->albedo[c], x->w.z) : m->albedo[c];
        if (m->kind == DIELECTRIC) factor[c] = v.z > 0 ? 1 : m->albedo[c] / (x->eta * x->eta);
    }
    if (smooth(m)) return v;
    if (v.z == 0 && m->kind != FOG) {
        factor[0] = factor[1] = factor[2] = *pdf = 0;
        return v;
    }
    double value[3];
    scatter(s, x, v, value, pdf);
    for (int c = 0; c < 3; ++c) factor[c] = *pdf > 0 ? value[c] / *pdf : 0;
    return v;
}

/* ---- lights ---- */

static double cone(const primitive *p, vec from) { /* the cosine of its half angle; 2 from inside */
    double square = p->b.x * p->b.x, off = dot(sub(p->a, from), sub(p->a, from));
    return off > square ? sqrt(1 - square / off) : 2;
}
static vec facing(const primitive *p, vec point) { return p->kind == SPHERE ? unit(sub(point, p->a)) : p->normal; }
/* Density by solid angle with which `from` would draw the direction d to the primitive, hit at a distance. */
static double light_density(const primitive *p, vec from, vec d, double distance) {
    if (p->kind != SPHERE) return distance * distance / (fabs(dot(d, p->normal)) * p->area);
    double lowest = cone(p, from);
    return lowest < 1 ? 1 / (2 * PI * (1 - lowest)) : 0;
}
/* A direction to the primitive and the distance; returns the density, 0 where no light comes from there. */
static double sample_primitive(const primitive *p, vec from, random *r, vec *d, double *distance) {
    if (p->kind == SPHERE) {
        double lowest = cone(p, from);
        if (lowest >= 1) return 0;
        *d = to_world(unit(sub(p->a, from)), on_sphere_cap(r, lowest));
        *distance = hit_sphere(p, from, *d, 1e-9 * p->b.x);
        if (isinf(*distance) || dot(facing(p, add(from, times(*distance, *d))), *d) >= 0) return 0; /* on its inside */
        return light_density(p, from, *d, *distance);
    }
    double u = draw(r), v = draw(r);
    vec point;
    if (p->kind == TRIANGLE) {
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        point = add(p->a, add(times(u, p->b), times(v, p->c)));
    } else {
        double radius = p->c.x * sqrt(u);
        point = add(p->a, to_world(p->normal, make(radius * cos(2 * PI * v), radius * sin(2 * PI * v), 0)));
    }
    vec way = sub(point, from);
    *distance = sqrt(dot(way, way));
    *d = times(1 / *distance, way);
    return dot(*d, p->normal) < 0 ? light_density(p, from, *d, *distance) : 0;
}

static double patch_angle(const scene *s, int64_t row) {
    double h = (double)s->sky_height;
    return 2 * PI / (double)s->sky_width * (cos(PI * (double)row / h) - cos(PI * (double)(row + 1) / h));
}
static double sky_power(const scene *s) {
    double sum = 0;
    for (int64_t k = 0; k < s->sky_width * s->sky_height; ++k)
        sum += luminance(s->sky + 3 * k) * patch_angle(s, k / s->sky_width);
    return sum;
}
static const double *sky_patch(const scene *s, vec d) {
    double longitude = atan2(dot(d, s->sky_left), dot(d, s->sky_front)), up = fmin(fmax(dot(d, s->sky_up), -1), 1);
    int64_t column = (int64_t)((0.5 - longitude / (2 * PI)) * (double)s->sky_width);
    int64_t row = (int64_t)(acos(up) / PI * (double)s->sky_height);
    column = column < s->sky_width ? column : s->sky_width - 1;
    row = row < s->sky_height ? row : s->sky_height - 1;
    return s->sky + 3 * (row * s->sky_width + column);
}
/* A direction in proportion to the radiance of its patch. */
static vec sample_sky(const scene *s, double power, random *r) {
    double left = draw(r) * power, h = (double)s->sky_height;
    int64_t k = 0, last = s->sky_width * s->sky_height - 1;
    while (k < last && (left -= luminance(s->sky + 3 * k) * patch_angle(s, k / s->sky_width)) > 0) ++k;
    double top = cos(PI * (double)(k / s->sky_width) / h), bottom = cos(PI * (double)(k / s->sky_width + 1) / h);
    double z = top + draw(r) * (bottom - top), ring = sqrt(fmax(0, 1 - z * z));
    double longitude = PI * (1 - 2 * ((double)(k % s->sky_width) + draw(r)) / (double)s->sky_width);
    return add(times(z, s->sky_up),
               add(times(ring * cos(longitude), s->sky_front), times(ring * sin(longitude), s->sky_left)));
}

/* What may arrive at a vertex from the lights, all of them: one is kept. */
typedef struct arrival {
    double total, value[3], distance; /* value: of the one kept, before it is divided by its share */
    vec d;
} arrival;

static void consider(const scene *s, const vertex *x, vec d, double distance, double density, int delta,
                     const double radiance[3], random *r, arrival *kept) {
    double value[3], pdf;
    if (!(density > 0)) return;
    scatter(s, x, to_local(x->normal, d), value, &pdf);
    double weight = delta ? 1 : 1 / (density + pdf), fog = s->scattering + s->absorption;
    if (fog > 0) weight *= exp(-fog * distance);
    for (int c = 0; c < 3; ++c) value[c] *= radiance[c] * weight;
    double share = luminance(value);
    if (!(share > 0)) return;
    kept->total += share;
    if (draw(r) * kept->total > share) return;
    for (int c = 0; c < 3; ++c) kept->value[c] = value[c] / share;
    kept->distance = distance;
    kept->d = d;
}
static void gather(const scene *s, const vertex *x, double sky, random *r, const double carried[3], double *out) {
    arrival kept = {0};
    double distance = 0;
    vec d;
    for (int64_t i = 0; i < s->primitive_count; ++i) {
        const primitive *p = s->primitives + i;
        const double *emission = s->materials[(int)p->material].emission;
        if (luminance(emission) == 0 || p->area == 0) continue;
        double density = sample_primitive(p, x->point, r, &d, &distance);
        consider(s, x, d, distance, density, 0, emission, r, &kept);
    }
    for (int64_t i = 0; i < s->sun_count; ++i) {
        const sun *u = s->suns + i;
        double lowest = cos(u->angle);
        d = u->angle > 0 ? to_world(u->axis, on_sphere_cap(r, lowest)) : u->axis;
        consider(s, x, d, INFINITY, u->angle > 0 ? 1 / (2 * PI * (1 - lowest)) : 1, u->angle == 0, u->radiance, r,
                 &kept);
    }
    if (s->sky) {
        d = sample_sky(s, sky, r);
        const double *radiance = sky_patch(s, d);
        consider(s, x, d, INFINITY, luminance(radiance) / sky, 0, radiance, r, &kept);
    }
    if (kept.total == 0 || blocked(s, x->point, kept.d, kept.distance)) return;
    for (int c = 0; c < 3; ++c) out[c] += carried[c] * kept.value[c] * kept.total;
}
/* From where the ray leaves the scene; pdf: with which its direction was drawn. */
static void miss(const scene *s, vec d, double pdf, double sky, const double carried[3], double *out) {
    double sum[3] = {s->background[0], s->background[1], s->background[2]};
    for (int64_t i = 0; i < s->sun_count; ++i) {
        const sun *u = s->suns + i;
        double share = isinf(pdf) ? 1 : pdf / (pdf + 1 / (2 * PI * (1 - cos(u->angle))));
        if (u->angle > 0 && dot(d, u->axis) >= cos(u->angle))
            for (int c = 0; c < 3; ++c) sum[c] += share * u->radiance[c];
    }
    if (s->sky) {
        const double *radiance = sky_patch(s, d);
        double share = isinf(pdf) ? 1 : pdf / (pdf + luminance(radiance) / sky);
        for (int c = 0; c < 3; ++c) sum[c] += share * radiance[c];
    }
    for (int c = 0; c < 3; ++c) out[c] += carried[c] * sum[c];
}

/* ---- paths ---- */

static void add_emission(const scene *s, const primitive *p, vec o, vec d, double distance, double pdf,
                         const double carried[3], double *out) {
    const double *emission = s->materials[(int)p->material].emission;
    if (luminance(emission) == 0 || dot(facing(p, add(o, times(distance, d))), d) >= 0) return;
    double share = isinf(pdf) ? 1 : pdf / (pdf + light_density(p, o, d, distance));
    for (int c = 0; c < 3; ++c) out[c] += carried[c] * emission[c] * share;
}
/* Adds the path's radiance to out[0 .. 2], and 1 to out[3] where its first ray meets something. */
static void follow(const scene *s, vec o, vec d, double weight, double sky, random *r, double out[4]) {
    double carried[3] = {weight, weight, weight}, pdf = INFINITY, distance, fog = s->scattering + s->absorption;
    material mist = {.kind = FOG};
    for (int c = 0; c < 3; ++c) mist.albedo[c] = fog > 0 ? s->scattering / fog : 0;
    for (int64_t bounce = 0;; ++bounce) {
        int64_t found = trace(s, o, d, &distance);
        double way = fog > 0 ? -log(1 - draw(r)) / fog : INFINITY, factor[3];
        int drifts = way < distance;
        if (bounce == 0) out[3] += found >= 0 || drifts;
        const primitive *p = s->primitives + (found < 0 ? 0 : found);
        if (!drifts && found < 0) miss(s, d, pdf, sky, carried, out);
        if (!drifts && found >= 0) add_emission(s, p, o, d, distance, pdf, carried, out);
        if ((!drifts && found < 0) || bounce == s->max_bounces) return;
        vertex x = {.m = drifts ? &mist : s->materials + (int)p->material, .eta = 1};
        x.point = add(o, times(drifts ? way : distance, d));
        x.normal = drifts ? times(-1, d) : facing(p, x.point);
        int outside = dot(x.normal, d) < 0;
        if (x.m->kind == DIELECTRIC) x.eta = outside ? x.m->ior : 1 / x.m->ior;
        if (!outside) x.normal = times(-1, x.normal);
        x.w = to_local(x.normal, times(-1, d));
        if (!smooth(x.m)) gather(s, &x, sky, r, carried, out);
        d = unit(to_world(x.normal, sample(s, &x, r, factor, &pdf)));
        for (int c = 0; c < 3; ++c) carried[c] *= factor[c];
        if (luminance(carried) == 0) return;
        o = x.point;
    }
}

/* ---- pictures ---- */

/* Renders `spp` samples of each of the pixels that `wanted` marks into out (height x width x 4: R, G, B,
 * share of rays that met something). Samples of different seeds are independent. */
void reference_render(const scene *s, uint64_t seed, int64_t spp, const uint8_t *wanted, double *out) {
    filter_table table;
    double sky = s->sky ? sky_power(s) : 0;
    random r = {mix(seed + 1), mix(seed ^ 0x5851f42d4c957f2du)};
    tabulate(&table, s->filter);
    for (int64_t k = 0; k < s->width * s->height; ++k) {
        double *pixel = out + 4 * k;
        for (int64_t n = 0; wanted[k] && n < spp; ++n) {
            double x, y, weight;
            do {
                weight = 1;
                x = place(&table, draw(&r), draw(&r), &weight);
                y = place(&table, draw(&r), draw(&r), &weight);
            } while (s->filter == GAUSSIAN_TRUNCATED && x * x + y * y > table.reach * table.reach);
            double across = ((double)(k % s->width) + 0.5 + x - (double)s->width / 2) * s->pixel;
            double down = ((double)(k / s->width) + 0.5 + y - (double)s->height / 2) * s->pixel;
            vec d = add(s->forward, sub(times(across, s->right), times(down, s->up))), o = s->eye;
            if (s->lens > 0) {
                double radius = s->lens * sqrt(draw(&r)), turn = 2 * PI * draw(&r);
                o = add(o, add(times(radius * cos(turn), s->right), times(radius * sin(turn), s->up)));
                d = sub(add(s->eye, times(s->focus, d)), o);
            }
            follow(s, o, unit(d), weight, sky, &r, pixel);
        }
        for (int c = 0; c < 4; ++c) pixel[c] /= (double)spp;
    }
}
