/* The C interface, driven from strict C11: a small bar falls, hangs on its support, and every mistake is a status with a text. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "supple/bindings/c/supple.h"

static int failures = 0;

static void check(int holds, const char* what, int line) {
    if (holds) return;
    ++failures;
    fprintf(stderr, "test_c_api.c:%d: failed: %s (last error: %s)\n", line, what, supple_last_error());
}
#define CHECK(condition) check((condition) ? 1 : 0, #condition, __LINE__)
#define CHECK_FAILS(call, expected, word)                                   \
    do {                                                                    \
        CHECK((call) == (expected));                                        \
        CHECK(strstr(supple_last_error(), word) != NULL);                   \
    } while (0)

enum { kCells = 4, kVertices = 2 * 2 * (kCells + 1), kTets = 6 * kCells };

/* A bar of kCells cubes along x, each cut into six tets around its diagonal. */
static void make_bar(double vertices[3 * kVertices], int32_t tets[4 * kTets]) {
    static const int kPaths[6][2] = {{1, 2}, {2, 1}, {1, 4}, {4, 1}, {2, 4}, {4, 2}}; /* corner bits x=1 y=2 z=4 */
    for (int v = 0; v < kVertices; ++v) {
        vertices[3 * v] = 0.1 * (v / 4);
        vertices[3 * v + 1] = 0.1 * (v % 2);
        vertices[3 * v + 2] = 0.1 * (v / 2 % 2);
    }
    int n = 0;
    for (int c = 0; c < kCells; ++c) {
        for (int p = 0; p < 6; ++p) {
            const int corners[4] = {0, kPaths[p][0], kPaths[p][0] | kPaths[p][1], 7};
            for (int k = 0; k < 4; ++k) {
                const int x = corners[k] & 1, y = corners[k] >> 1 & 1, z = corners[k] >> 2 & 1;
                tets[n++] = 4 * (c + x) + y + 2 * z;
            }
        }
    }
}

static SuppleWorld* make_world(void) {
    SuppleWorldDef def;
    SuppleWorld* world = NULL;
    CHECK(supple_world_def_default(&def, sizeof def) == SUPPLE_OK);
    CHECK(def.struct_size == sizeof def);
    CHECK(fabs(def.gravity_m_s2[1] + 9.81) < 1e-12);
    def.time_step_s = 0.01;
    def.threads = 1;
    CHECK(supple_world_create(&def, &world) == SUPPLE_OK);
    CHECK(world != NULL);
    return world;
}

static SuppleBodyDef bar_def(const double* vertices, const int32_t* tets) {
    SuppleBodyDef def;
    CHECK(supple_body_def_default(&def, sizeof def) == SUPPLE_OK);
    def.name = "bar";
    def.vertices_m = vertices;
    def.vertex_count = kVertices;
    def.tets = tets;
    def.tet_count = kTets;
    def.young_pa = 1e5;
    def.poisson = 0.4;
    return def;
}

/* Free fall by implicit Euler: y falls by g h^2 n(n+1)/2, without deformation. */
static void test_fall(const SuppleBodyDef* bar) {
    SuppleWorld* world = make_world();
    SuppleBodyId body;
    SuppleStepReport report;
    double before[3 * kVertices], after[3 * kVertices], velocities[3 * kVertices], stress[kVertices];
    size_t count = 0;
    uint64_t hash_before = 0, hash_after = 0;
    CHECK(supple_world_add_body(world, bar, &body) == SUPPLE_OK);
    CHECK(body.generation != 0);
    CHECK(supple_world_vertex_count(world, body, &count) == SUPPLE_OK && count == kVertices);
    CHECK(supple_world_positions(world, body, before, 3 * kVertices) == SUPPLE_OK);
    CHECK(memcmp(before, bar->vertices_m, sizeof before) == 0);
    CHECK(supple_world_hash(world, &hash_before) == SUPPLE_OK);
    CHECK(supple_step_report_default(&report, sizeof report) == SUPPLE_OK);
    for (int i = 0; i < 20; ++i) CHECK(supple_world_step(world, &report) == SUPPLE_OK);
    CHECK(report.step == 20 && report.flags == 0 && report.steps == 1);
    CHECK(fabs(report.time_s - 0.2) < 1e-12);
    CHECK(supple_world_positions(world, body, after, 3 * kVertices) == SUPPLE_OK);
    CHECK(supple_world_velocities(world, body, velocities, 3 * kVertices) == SUPPLE_OK);
    CHECK(supple_world_von_mises(world, body, stress, kVertices) == SUPPLE_OK);
    for (int v = 0; v < kVertices; ++v) {
        CHECK(fabs(before[3 * v + 1] - after[3 * v + 1] - 9.81 * 1e-4 * 20 * 21 / 2) < 1e-6);
        CHECK(fabs(velocities[3 * v + 1] + 9.81 * 0.2) < 1e-5);
        CHECK(stress[v] >= 0 && stress[v] < 10);
    }
    CHECK(supple_world_hash(world, &hash_after) == SUPPLE_OK && hash_after != hash_before);
    supple_world_destroy(world);
}

static void test_hang(const SuppleBodyDef* bar) {
    const double low[3] = {-1, -1, -1}, high[3] = {1e-6, 1, 1};
    const int32_t end[4] = {0, 1, 2, 3};
    double by_box[3 * kVertices], by_list[3 * kVertices];
    size_t count = 0;
    for (int way = 0; way < 2; ++way) {
        SuppleWorld* world = make_world();
        SuppleBodyId body;
        CHECK(supple_world_add_body(world, bar, &body) == SUPPLE_OK);
        if (way == 0) {
            CHECK(supple_world_fix_box(world, body, low, high, &count) == SUPPLE_OK);
            CHECK(count == 4);
        } else {
            CHECK(supple_world_fix_vertices(world, body, end, 4) == SUPPLE_OK);
        }
        for (int i = 0; i < 20; ++i) CHECK(supple_world_step(world, NULL) == SUPPLE_OK);
        CHECK(supple_world_positions(world, body, way == 0 ? by_box : by_list, 3 * kVertices) == SUPPLE_OK);
        supple_world_destroy(world);
    }
    CHECK(memcmp(by_box, by_list, sizeof by_box) == 0);
    CHECK(memcmp(by_box, bar->vertices_m, 12 * sizeof(double)) == 0); /* held */
    CHECK(by_box[3 * (kVertices - 1) + 1] < 0.1 - 1e-3);              /* the free end sags */
}

static void test_advance(const SuppleBodyDef* bar) {
    SuppleWorld* world = make_world();
    SuppleBodyId body;
    SuppleStepReport report;
    CHECK(supple_world_add_body(world, bar, &body) == SUPPLE_OK);
    CHECK(supple_step_report_default(&report, sizeof report) == SUPPLE_OK);
    CHECK(supple_world_advance(world, 0.025, &report) == SUPPLE_OK);
    CHECK(report.steps == 2 && fabs(report.alpha - 0.5) < 1e-9);
    CHECK_FAILS(supple_world_advance(world, -1.0, &report), SUPPLE_INVALID_ARGUMENT, "real_seconds");
    CHECK_FAILS(supple_world_advance(world, NAN, &report), SUPPLE_INVALID_ARGUMENT, "real_seconds");
    supple_world_destroy(world);
}

/* Two bars, one above the other: they touch, unless they are told not to; glued, the lower hangs from the upper. */
static void test_bodies_touch(const SuppleBodyDef* bar) {
    SuppleWorldDef world_def;
    SuppleWorld* world = NULL;
    SuppleBodyDef def = *bar;
    SuppleBodyId low, high;
    SuppleContact contacts[256];
    size_t count = 0, tied = 0;
    int n;
    CHECK(def.touches_bodies == 1 && def.touches_itself == 0 && def.friction == 0.3);
    CHECK(supple_world_def_default(&world_def, sizeof world_def) == SUPPLE_OK);
    world_def.threads = 1;
    CHECK(supple_world_create(&world_def, &world) == SUPPLE_OK);
    CHECK(supple_world_add_body(world, &def, &low) == SUPPLE_OK);
    def.translation_m[1] += 0.1001;
    CHECK(supple_world_add_body(world, &def, &high) == SUPPLE_OK);
    {
        const double min[3] = {-1, -1, -1}, max[3] = {1, 0.001, 1};
        CHECK(supple_world_fix_box(world, low, min, max, NULL) == SUPPLE_OK);
    }
    for (n = 0; n < 20; ++n) CHECK(supple_world_step(world, NULL) == SUPPLE_OK);
    CHECK(supple_world_contact_count(world, &count) == SUPPLE_OK && count > 0 && count <= 256);
    CHECK(supple_world_contacts(world, contacts, 256) == SUPPLE_OK);
    CHECK(contacts[0].collider.generation == 0 && contacts[0].other.generation != 0 && contacts[0].other_triangle >= 0);
    CHECK(supple_world_set_contact(world, low, high, 2) == SUPPLE_INVALID_ARGUMENT);
    CHECK(supple_world_set_contact(world, low, high, 0) == SUPPLE_OK);
    CHECK(supple_world_step(world, NULL) == SUPPLE_OK);
    CHECK(supple_world_contact_count(world, &count) == SUPPLE_OK && count == 0);
    CHECK(supple_world_tie(world, high, low, -1, 0, 0, &tied) == SUPPLE_INVALID_ARGUMENT);
    CHECK(supple_world_tie(world, high, low, 0.01, 0, 0, &tied) == SUPPLE_OK && tied >= 4);
    CHECK(supple_world_step(world, NULL) == SUPPLE_OK);
    def.touches_itself = 3;
    CHECK(supple_world_add_body(world, &def, &high) == SUPPLE_INVALID_ARGUMENT);
    supple_world_destroy(world);
}

/* A bar falls on a plane; a ball is pressed on it. */
static void test_contact(const SuppleBodyDef* bar) {
    SuppleWorldDef world_def;
    SuppleWorld* world = NULL;
    SuppleBodyId body;
    SuppleColliderDef def;
    SuppleColliderId plane, ball;
    SuppleColliderState state;
    SuppleContact contacts[256];
    const double one[4] = {1, 0, 0, 0};
    double sum = 0, start[3] = {0.2, 0.2, 0.05};
    size_t count = 0, i;
    int n;
    CHECK(supple_world_def_default(&world_def, sizeof world_def) == SUPPLE_OK);
    world_def.threads = 1;
    CHECK(supple_world_create(&world_def, &world) == SUPPLE_OK);
    CHECK(supple_world_add_body(world, bar, &body) == SUPPLE_OK);
    CHECK(supple_collider_def_default(&def, sizeof def) == SUPPLE_OK);
    CHECK(def.shape == SUPPLE_SHAPE_PLANE && def.size[1] == 1 && def.rotation_wxyz[0] == 1);
    def.plane_offset_m = -0.01;
    CHECK(supple_world_add_collider(world, &def, &plane) == SUPPLE_OK);
    def.shape = SUPPLE_SHAPE_SPHERE;
    def.motion = SUPPLE_COLLIDER_KINEMATIC;
    def.size[0] = 0.03;
    for (i = 0; i < 3; ++i) def.position_m[i] = start[i];
    CHECK(supple_world_add_collider(world, &def, &ball) == SUPPLE_OK);
    for (n = 0; n < 200; ++n) {
        start[1] = 0.2 - 0.0005 * n;
        CHECK(supple_world_move_collider(world, ball, start, one) == SUPPLE_OK);
        CHECK(supple_world_step(world, NULL) == SUPPLE_OK);
    }
    CHECK(supple_collider_state_default(&state, sizeof state) == SUPPLE_OK);
    CHECK(supple_world_collider_state(world, ball, &state) == SUPPLE_OK);
    CHECK(state.struct_size == sizeof state && fabs(state.position_m[1] - start[1]) < 1e-12);
    CHECK(state.force_n[1] > 0);
    CHECK(supple_world_contact_count(world, &count) == SUPPLE_OK);
    CHECK(count > 0 && count <= 256);
    CHECK(supple_world_contacts(world, contacts, 0) == SUPPLE_INVALID_ARGUMENT);
    CHECK(supple_world_contacts(world, contacts, 256) == SUPPLE_OK);
    for (i = 0; i < count; ++i) {
        CHECK(contacts[i].body.generation == body.generation && contacts[i].triangle >= 0);
        if (contacts[i].collider.index == ball.index) sum += contacts[i].normal_force_n * contacts[i].normal[1] + contacts[i].friction_force_n[1];
    }
    CHECK(fabs(sum + state.force_n[1]) < 1e-9);
    CHECK(supple_world_remove_collider(world, ball) == SUPPLE_OK);
    CHECK(supple_world_remove_collider(world, ball) == SUPPLE_STALE_ID);
    def.shape = 17;
    CHECK(supple_world_add_collider(world, &def, &ball) == SUPPLE_INVALID_ARGUMENT);
    def.shape = SUPPLE_SHAPE_MESH;
    CHECK(supple_world_add_collider(world, &def, &ball) == SUPPLE_INVALID_ARGUMENT);
    CHECK(strcmp(supple_flag_name(SUPPLE_FLAG_CONTACT_CAP), "contact_cap") == 0);
    supple_world_destroy(world);
}

static void test_errors(const SuppleBodyDef* bar) {
    SuppleWorld* world = make_world();
    SuppleWorld* none = NULL;
    SuppleWorldDef def;
    SuppleBodyDef bad;
    SuppleStepReport report;
    SuppleBodyId body, stale, other = {0, 0};
    double buffer[3 * kVertices];
    const int32_t outside[1] = {kVertices};
    size_t count = 7;

    CHECK(supple_world_def_default(&def, sizeof def) == SUPPLE_OK);
    def.time_step_s = -1;
    CHECK_FAILS(supple_world_create(&def, &none), SUPPLE_INVALID_ARGUMENT, "time_step_s");
    CHECK(none == NULL);
    CHECK(supple_world_def_default(&def, sizeof def) == SUPPLE_OK);
    def.precision = 9;
    CHECK_FAILS(supple_world_create(&def, &none), SUPPLE_INVALID_ARGUMENT, "precision");
    def.struct_size = 3;
    CHECK_FAILS(supple_world_create(&def, &none), SUPPLE_INVALID_ARGUMENT, "struct_size");
    CHECK_FAILS(supple_world_create(NULL, &none), SUPPLE_INVALID_ARGUMENT, "null");
    CHECK_FAILS(supple_world_create(&def, NULL), SUPPLE_INVALID_ARGUMENT, "null");
    CHECK_FAILS(supple_world_def_default(&def, 8), SUPPLE_INVALID_ARGUMENT, "struct_size");

    bad = *bar;
    bad.poisson = 0.5;
    CHECK_FAILS(supple_world_add_body(world, &bad, &body), SUPPLE_INVALID_ARGUMENT, "poisson");
    bad = *bar;
    bad.tets = NULL;
    CHECK_FAILS(supple_world_add_body(world, &bad, &body), SUPPLE_INVALID_ARGUMENT, "tets");
    bad = *bar;
    bad.vertex_count = 3; /* the tets now point past the end */
    CHECK_FAILS(supple_world_add_body(world, &bad, &body), SUPPLE_INVALID_ARGUMENT, "");
    CHECK(body.generation == 0);
    CHECK_FAILS(supple_world_positions(world, body, buffer, 3 * kVertices), SUPPLE_STALE_ID, "");

    CHECK(supple_world_add_body(world, bar, &body) == SUPPLE_OK);
    CHECK_FAILS(supple_world_positions(world, body, buffer, 5), SUPPLE_INVALID_ARGUMENT, "buffer");
    CHECK_FAILS(supple_world_positions(world, body, NULL, 3 * kVertices), SUPPLE_INVALID_ARGUMENT, "buffer");
    CHECK_FAILS(supple_world_fix_vertices(world, body, outside, 1), SUPPLE_INVALID_ARGUMENT, "");
    CHECK_FAILS(supple_world_vertex_count(world, other, &count), SUPPLE_STALE_ID, "");
    stale = body;
    CHECK(supple_world_remove_body(world, body) == SUPPLE_OK);
    CHECK_FAILS(supple_world_positions(world, stale, buffer, 3 * kVertices), SUPPLE_STALE_ID, "");
    CHECK_FAILS(supple_world_step(NULL, NULL), SUPPLE_INVALID_ARGUMENT, "null");
    report.struct_size = 1;
    CHECK_FAILS(supple_world_step(world, &report), SUPPLE_INVALID_ARGUMENT, "struct_size");
    supple_world_destroy(world);
    supple_world_destroy(NULL);
}

static void test_edits(const SuppleBodyDef* bar) {
    SuppleWorld* world = NULL;
    SuppleBodyId body, piece;
    size_t before = 0, after = 0, triangles = 0, pieces = 0, made = 0, touched = 0;
    const double from[6] = {0.0371, -1, -1, 0.0371, -1, 1}, to[6] = {0.0371, 1, -1, 0.0371, 1, 1};
    const int32_t one[1] = {0}, outside[1] = {1 << 20};
    int32_t undone = 0, few[3];
    CHECK(supple_world_create(NULL, &world) != SUPPLE_OK);
    {
        SuppleWorldDef def;
        CHECK(supple_world_def_default(&def, sizeof def) == SUPPLE_OK);
        CHECK(supple_world_create(&def, &world) == SUPPLE_OK);
    }
    CHECK(supple_world_add_body(world, bar, &body) == SUPPLE_OK);
    CHECK(supple_world_element_count(world, body, &before) == SUPPLE_OK);
    CHECK(supple_world_triangle_count(world, body, &triangles) == SUPPLE_OK && triangles > 0);
    CHECK_FAILS(supple_world_triangles(world, body, few, 3), SUPPLE_INVALID_ARGUMENT, "buffer");
    CHECK(supple_world_cut(world, body, from, to, 2, &touched) == SUPPLE_OK && touched > 0);
    CHECK(supple_world_element_count(world, body, &after) == SUPPLE_OK && after > before);
    CHECK(supple_world_piece_count(world, body, &pieces) == SUPPLE_OK && pieces == 2);
    CHECK(supple_world_step(world, NULL) == SUPPLE_OK);
    CHECK(supple_world_undo_edit(world, body, &undone) == SUPPLE_OK && undone == 1);
    CHECK(supple_world_element_count(world, body, &after) == SUPPLE_OK && after == before);
    CHECK(supple_world_undo_edit(world, body, &undone) == SUPPLE_OK && undone == 0);
    CHECK(supple_world_cut(world, body, from, to, 2, NULL) == SUPPLE_OK);
    CHECK(supple_world_heal(world, body, 0.01, &touched) == SUPPLE_OK && touched > 0);
    CHECK(supple_world_piece_count(world, body, &pieces) == SUPPLE_OK && pieces == 1);
    CHECK_FAILS(supple_world_heal(world, body, 0, NULL), SUPPLE_INVALID_ARGUMENT, "gap_m");
    {   /* a tet on a triangle of the surface */
        static int32_t surface[3 * 4096];
        static double x[3 * 4096];
        size_t n = 0, count = 0;
        double tip[3], u[3], v[3];
        int32_t tet[4];
        int k;
        CHECK(supple_world_vertex_count(world, body, &n) == SUPPLE_OK && n <= 4096);
        CHECK(supple_world_positions(world, body, x, 3 * n) == SUPPLE_OK);
        CHECK(supple_world_triangle_count(world, body, &count) == SUPPLE_OK && count <= 4096);
        CHECK(supple_world_triangles(world, body, surface, 3 * count) == SUPPLE_OK);
        for (k = 0; k < 3; ++k) {
            u[k] = x[3 * surface[1] + k] - x[3 * surface[0] + k];
            v[k] = x[3 * surface[2] + k] - x[3 * surface[0] + k];
            tet[k] = surface[k];
        }
        tet[3] = (int32_t)n;
        for (k = 0; k < 3; ++k) tip[k] = x[3 * surface[0] + k] + 10 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
        CHECK(supple_world_element_count(world, body, &before) == SUPPLE_OK);
        CHECK(supple_world_add_tets(world, body, tip, 1, tet, 1, 0) == SUPPLE_OK);
        CHECK(supple_world_element_count(world, body, &after) == SUPPLE_OK && after == before + 1);
        CHECK_FAILS(supple_world_add_tets(world, body, tip, 1, tet, 1, 1000000), SUPPLE_INVALID_ARGUMENT, "source");
        CHECK(supple_world_undo_edit(world, body, &undone) == SUPPLE_OK && undone == 1);
    }
    CHECK(supple_world_undo_edit(world, body, &undone) == SUPPLE_OK && undone == 1);
    CHECK(supple_world_split_off_pieces(world, body, &piece, 1, &made) == SUPPLE_OK && made == 1);
    CHECK(supple_world_piece_count(world, piece, &pieces) == SUPPLE_OK && pieces == 1);
    CHECK(supple_world_remove_elements(world, body, one, 1, &touched) == SUPPLE_OK && touched >= 1);
    CHECK_FAILS(supple_world_remove_elements(world, body, outside, 1, NULL), SUPPLE_INVALID_ARGUMENT, "outside");
    CHECK_FAILS(supple_world_cut(world, body, from, to, 1, NULL), SUPPLE_INVALID_ARGUMENT, "two points");
    CHECK(supple_world_step(world, NULL) == SUPPLE_OK);
    supple_world_destroy(world);
}

/* A program built against a later header has longer structs: unknown fields may be zero, not set. */
static void test_versions(void) {
    struct {
        SuppleWorldDef def;
        double later_field;
    } newer;
    SuppleWorld* world = NULL;
    newer.later_field = 5;
    CHECK(supple_world_def_default(&newer.def, sizeof newer) == SUPPLE_OK);
    CHECK(newer.later_field == 0 && newer.def.struct_size == sizeof newer);
    CHECK(supple_world_create(&newer.def, &world) == SUPPLE_OK);
    supple_world_destroy(world);
    newer.later_field = 1;
    CHECK_FAILS(supple_world_create(&newer.def, &world), SUPPLE_INVALID_ARGUMENT, "newer");
    CHECK(world == NULL);
}

static void test_words(void) {
    CHECK(supple_version()[0] != '\0');
    CHECK(strcmp(supple_status_name(SUPPLE_OK), "ok") == 0);
    CHECK(strcmp(supple_status_name(SUPPLE_STALE_ID), "unknown") != 0);
    CHECK(strcmp(supple_flag_name(SUPPLE_FLAG_NON_FINITE), "non_finite") == 0);
    CHECK(supple_flag_cure(SUPPLE_FLAG_ITERATION_CAP)[0] != '\0');
    CHECK(supple_flag_name(3)[0] == '\0' && supple_flag_cure(1u << 31)[0] == '\0');
}

int main(void) {
    double vertices[3 * kVertices];
    int32_t tets[4 * kTets];
    SuppleBodyDef bar;
    CHECK(supple_last_error()[0] == '\0');
    make_bar(vertices, tets);
    bar = bar_def(vertices, tets);
    test_fall(&bar);
    test_hang(&bar);
    test_advance(&bar);
    test_bodies_touch(&bar);
    test_contact(&bar);
    test_edits(&bar);
    test_errors(&bar);
    test_versions();
    test_words();
    if (failures == 0) printf("all checks passed\n");
    return failures == 0 ? 0 : 1;
}
