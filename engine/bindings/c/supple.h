#ifndef SUPPLE_C_H
#define SUPPLE_C_H
/*
 * C interface of Supple.
 *
 *   - Every function that can fail returns a SuppleStatus; supple_last_error() then holds the sentence, per thread.
 *   - Definition and report structs begin with struct_size. Fill them with their *_default() function, then edit:
 *         SuppleWorldDef def;
 *         supple_world_def_default(&def, sizeof def);
 *     A program compiled against an older header keeps working with a newer library, and the other way round as long as it
 *     leaves the fields that the library does not know at zero.
 *   - Arrays go in and come out by copy: xyz triples of doubles, SI units, in the order of the caller's mesh.
 *   - A world belongs to one thread at a time; different worlds are independent. No exception leaves a function.
 */
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum SuppleStatus {
    SUPPLE_OK = 0,
    SUPPLE_INVALID_ARGUMENT = 1, /* a value outside its legal range, a null pointer, a buffer that is too small */
    SUPPLE_STALE_ID = 2,         /* a body that is gone */
    SUPPLE_FILE_UNREADABLE = 3,
    SUPPLE_PARSE = 4,
    SUPPLE_UNSUPPORTED = 5,
    SUPPLE_SURFACE_MESH = 6,     /* no volume element in the mesh */
    SUPPLE_CORRUPT_SNAPSHOT = 7,
    SUPPLE_NO_DISPLAY = 8,
    SUPPLE_EXTERNAL_TOOL = 9,
    SUPPLE_OUT_OF_MEMORY = 100,
    SUPPLE_INTERNAL_ERROR = 101  /* a fault of the library: please report the text of supple_last_error() */
} SuppleStatus;

typedef struct SuppleWorld SuppleWorld;

/* Generation 0 is "none"; the id of a removed body is refused with SUPPLE_STALE_ID. */
typedef struct SuppleBodyId {
    uint32_t index;
    uint32_t generation;
} SuppleBodyId;

typedef enum SupplePrecision {
    SUPPLE_PRECISION_SINGLE = 0, /* float32 matrix and solver vectors, float64 positions, forces and residual */
    SUPPLE_PRECISION_DOUBLE = 1
} SupplePrecision;

typedef enum SuppleLineariseAt {
    SUPPLE_LINEARISE_AT_PREDICTION = 0, /* x + h v */
    SUPPLE_LINEARISE_AT_CURRENT = 1     /* x */
} SuppleLineariseAt;

typedef struct SuppleWorldDef {
    uint64_t struct_size;
    double gravity_m_s2[3];        /* default 0 -9.81 0 */
    double time_step_s;            /* (0, 1], default 1/120 */
    int32_t threads;               /* 0 = all cores; at most 256 */
    int32_t max_catch_up_steps;    /* 1..1000, for supple_world_advance() */
    int32_t newton_iterations;     /* 1..100 linear solves per step, default 1 */
    int32_t cg_max_iterations;     /* 1..1000000 */
    double cg_relative_tolerance;  /* (0, 1), on the true float64 residual */
    int32_t precision;             /* SupplePrecision */
    int32_t linearise_at;          /* SuppleLineariseAt */
    double rayleigh_mass_1_s;      /* [0, 1e6], default 0 */
    double rayleigh_stiffness_s;   /* [0, 1e3], default 0 */
} SuppleWorldDef;

typedef enum SuppleLaw {
    SUPPLE_LAW_COROTATIONAL = 0 /* linear elasticity in a frame that follows the polar rotation of each element */
} SuppleLaw;

typedef struct SuppleBodyDef {
    uint64_t struct_size;
    const char* name;              /* for messages, UTF-8; NULL = "body <index>" */
    const double* vertices_m;      /* rest positions, vertex_count xyz triples */
    uint64_t vertex_count;
    const int32_t* tets;           /* tet_count quadruples of vertex indices from 0; the winding is repaired */
    uint64_t tet_count;
    int32_t law;                   /* SuppleLaw */
    int32_t reserved;              /* zero */
    double young_pa;               /* Young's modulus, > 0, default 1e5 */
    double poisson;                /* Poisson's ratio, (-1, 0.5), default 0.3 */
    double density_kg_m3;          /* > 0, default 1000 */
    double translation_m[3];       /* of the start position */
    double velocity_m_s[3];        /* at the start */
    int32_t touches_bodies;        /* 1 (default): contact with other bodies that have it too; 0: none */
    int32_t touches_itself;        /* 1: contact of its surface with itself; default 0 */
    double friction;               /* Coulomb, against bodies, [0, 10], default 0.3; of a pair the geometric mean */
} SuppleBodyDef;

/* Bits of SuppleStepReport.flags; supple_flag_cure() says what to change. */
typedef enum SuppleStepFlag {
    SUPPLE_FLAG_ITERATION_CAP = 1,
    SUPPLE_FLAG_RESIDUAL_STALLED = 2,
    SUPPLE_FLAG_NON_FINITE = 4, /* a body became non-finite: rolled back to the start of the step and frozen */
    SUPPLE_FLAG_FROZEN = 8,
    SUPPLE_FLAG_NEWTON_CAP = 16,
    SUPPLE_FLAG_CONTACT_CAP = 512 /* contacts still changed when their iterations were used up */
} SuppleStepFlag;

typedef struct SuppleStepReport {
    uint64_t struct_size;
    uint64_t step;                 /* number of the last step, from 1 */
    double time_s;                 /* simulated time at its end */
    uint32_t flags;                /* SuppleStepFlag bits; 0 when all is well */
    int32_t cg_iterations;
    int32_t newton_iterations;
    int32_t steps;                 /* fixed steps that this call did */
    double step_ms;                /* wall clock of the last step */
    double cg_relative_residual;   /* float64 */
    double alpha;                  /* supple_world_advance(): draw (1-alpha) previous + alpha current */
} SuppleStepReport;

/* Generation 0 is "none". */
typedef struct SuppleColliderId {
    uint32_t index;
    uint32_t generation;
} SuppleColliderId;

typedef enum SuppleShape {
    SUPPLE_SHAPE_PLANE = 0,    /* solid where size . x < plane_offset_m; size is its normal */
    SUPPLE_SHAPE_SPHERE = 1,   /* size[0] radius */
    SUPPLE_SHAPE_CAPSULE = 2,  /* along y: size[0] radius, size[1] half length */
    SUPPLE_SHAPE_BOX = 3,      /* size: half extents */
    SUPPLE_SHAPE_CYLINDER = 4, /* along y: size[0] radius, size[1] half length */
    SUPPLE_SHAPE_MESH = 5      /* a closed surface: vertices_m and triangles */
} SuppleShape;

typedef enum SuppleColliderMotion {
    SUPPLE_COLLIDER_FIXED = 0,
    SUPPLE_COLLIDER_KINEMATIC = 1, /* gets where it is moved, by the end of the next step */
    SUPPLE_COLLIDER_TOOL = 2,      /* has a mass and is drawn to its target by a spring of limited force */
    SUPPLE_COLLIDER_DYNAMIC = 3    /* has a mass; moved by gravity and the bodies that it touches */
} SuppleColliderMotion;

typedef struct SuppleColliderDef {
    uint64_t struct_size;
    const char* name;              /* for messages, UTF-8; NULL = "collider <index>" */
    int32_t shape;                 /* SuppleShape */
    int32_t motion;                /* SuppleColliderMotion */
    double size[3];                /* by the shape; default 0 1 0: the normal of a plane */
    double plane_offset_m;
    double position_m[3];
    double rotation_wxyz[4];       /* default 1 0 0 0 */
    double friction;               /* Coulomb, [0, 10], default 0.3 */
    double mass_kg;                /* > 0 for a tool or a dynamic collider, else 0 */
    double velocity_m_s[3];        /* of these, at the start */
    double spin_rad_s[3];
    double tool_stiffness_n_m;     /* default 500 */
    double tool_damping_n_s_m;     /* 0: critical */
    double tool_max_force_n;       /* 0: no limit */
    const double* vertices_m;      /* of a mesh: vertex_count xyz triples */
    uint64_t vertex_count;
    const int32_t* triangles;      /* triangle_count triples of vertex indices from 0, closed */
    uint64_t triangle_count;
} SuppleColliderDef;

typedef struct SuppleColliderState {
    uint64_t struct_size;
    double position_m[3];
    double rotation_wxyz[4];
    double velocity_m_s[3];
    double spin_rad_s[3];
    double force_n[3];             /* of all soft bodies on it in the last step */
    double torque_nm[3];           /* of these, about its centre of mass (its origin where it has no mass) */
    double coupling_force_n[3];    /* of a tool's spring on it: what a hand feels is the opposite */
} SuppleColliderState;

/* A contact that pressed in the last step; forces act on the body. A plain array element: its size never changes. */
typedef struct SuppleContact {
    SuppleBodyId body;
    SuppleColliderId collider;     /* generation 0: another body */
    SuppleBodyId other;            /* that body, or the body itself; generation 0: a collider */
    int32_t triangle;              /* of the body's boundary */
    int32_t other_triangle;        /* of the other body's boundary; -1 */
    double position_m[3];
    double normal[3];              /* unit, out of the collider */
    double depth_m;
    double normal_force_n;
    double friction_force_n[3];
} SuppleContact;

const char* supple_version(void);                 /* "0.1.0" */
const char* supple_status_name(SuppleStatus status);
const char* supple_last_error(void);              /* of this thread's last failed call; "" before any. Valid until its next call */
const char* supple_flag_name(uint32_t one_bit);   /* "iteration_cap"; "" for an unknown bit */
const char* supple_flag_cure(uint32_t one_bit);   /* one sentence; "" for an unknown bit */

/* struct_size is the caller's sizeof; fails if it is smaller than the first version of the struct. */
SuppleStatus supple_world_def_default(SuppleWorldDef* def, size_t struct_size);
SuppleStatus supple_body_def_default(SuppleBodyDef* def, size_t struct_size);
SuppleStatus supple_step_report_default(SuppleStepReport* report, size_t struct_size);
SuppleStatus supple_collider_def_default(SuppleColliderDef* def, size_t struct_size);
SuppleStatus supple_collider_state_default(SuppleColliderState* state, size_t struct_size);

SuppleStatus supple_world_create(const SuppleWorldDef* def, SuppleWorld** out_world);
void supple_world_destroy(SuppleWorld* world);    /* NULL is fine */

SuppleStatus supple_world_add_body(SuppleWorld* world, const SuppleBodyDef* def, SuppleBodyId* out_body);
SuppleStatus supple_world_remove_body(SuppleWorld* world, SuppleBodyId body);

/* Hold vertices where they are. A selection that is empty is an error. out_count may be NULL. */
SuppleStatus supple_world_fix_vertices(SuppleWorld* world, SuppleBodyId body, const int32_t* vertices, size_t count);
SuppleStatus supple_world_fix_box(SuppleWorld* world, SuppleBodyId body, const double min_m[3], const double max_m[3],
                                  size_t* out_count);

/* One fixed step, or as many as real time asks for. out_report may be NULL; a raised flag is not a failed call. */
SuppleStatus supple_world_step(SuppleWorld* world, SuppleStepReport* out_report);
SuppleStatus supple_world_advance(SuppleWorld* world, double real_seconds, SuppleStepReport* out_report);

SuppleStatus supple_world_vertex_count(const SuppleWorld* world, SuppleBodyId body, size_t* out_count);

/* Copy results into a buffer of `capacity` doubles: 3 per vertex, or 1 per vertex for the von Mises stress [Pa]. */
SuppleStatus supple_world_positions(const SuppleWorld* world, SuppleBodyId body, double* xyz_m, size_t capacity);
SuppleStatus supple_world_previous_positions(const SuppleWorld* world, SuppleBodyId body, double* xyz_m, size_t capacity);
SuppleStatus supple_world_velocities(const SuppleWorld* world, SuppleBodyId body, double* xyz_m_s, size_t capacity);
SuppleStatus supple_world_von_mises(const SuppleWorld* world, SuppleBodyId body, double* stress_pa, size_t capacity);

/* Rigid things that the bodies touch. */
SuppleStatus supple_world_add_collider(SuppleWorld* world, const SuppleColliderDef* def, SuppleColliderId* out_collider);
SuppleStatus supple_world_remove_collider(SuppleWorld* world, SuppleColliderId collider);
/* A kinematic collider gets there by the end of the next step; a tool is drawn there from now on; others are put there at once, at rest. */
SuppleStatus supple_world_move_collider(SuppleWorld* world, SuppleColliderId collider, const double position_m[3], const double rotation_wxyz[4]);
SuppleStatus supple_world_collider_state(const SuppleWorld* world, SuppleColliderId collider, SuppleColliderState* out_state);
SuppleStatus supple_world_contact_count(const SuppleWorld* world, size_t* out_count);
SuppleStatus supple_world_contacts(const SuppleWorld* world, SuppleContact* contacts, size_t capacity);

/* Contact of two bodies, or of one with itself (a = b), from the next step on; until then their definitions decide. on is 0 or 1. */
SuppleStatus supple_world_set_contact(SuppleWorld* world, SuppleBodyId a, SuppleBodyId b, int32_t on);
/* Glues the surface of `body` to that of `other` where they are within gap_m. stiffness 0: hard; max_force 0: never breaks. out_count (may be NULL): vertices tied. */
SuppleStatus supple_world_tie(SuppleWorld* world, SuppleBodyId body, SuppleBodyId other, double gap_m, double stiffness_n_m, double max_force_n, size_t* out_count);

/* Edits of a body's mesh, between steps. Vertices and elements are numbered anew: read counts, positions and triangles again afterwards. What is on the body follows.
 * out_count, where given, gets the number of elements that went or were cut; 0: nothing was done. */
SuppleStatus supple_world_remove_elements(SuppleWorld* world, SuppleBodyId body, const int32_t* elements, size_t count, size_t* out_count);
/* Cuts with the strip that a polyline of point_count xyz triples sweeps between two poses, in the world. */
SuppleStatus supple_world_cut(SuppleWorld* world, SuppleBodyId body, const double* from_m, const double* to_m, size_t point_count, size_t* out_count);
/* Glues lips of cuts that are within gap_m of one another now. out_count: vertices that went into another one. */
SuppleStatus supple_world_heal(SuppleWorld* world, SuppleBodyId body, double gap_m, size_t* out_count);
/* Adds tets of four vertex indices each: those of the body, then new ones, whose rest positions are vertex_count xyz triples. All take over matter, region and motion of the tet `source`. */
SuppleStatus supple_world_add_tets(SuppleWorld* world, SuppleBodyId body, const double* vertices_m, size_t vertex_count, const int32_t* tets, size_t tet_count, int32_t source);
SuppleStatus supple_world_undo_edit(SuppleWorld* world, SuppleBodyId body, int32_t* out_undone); /* 1: undone; 0: there was nothing to undo */
/* Makes bodies of the pieces without support. Writes at most `capacity` of their ids; out_count gets how many there are. */
SuppleStatus supple_world_split_off_pieces(SuppleWorld* world, SuppleBodyId body, SuppleBodyId* bodies, size_t capacity, size_t* out_count);
SuppleStatus supple_world_piece_count(const SuppleWorld* world, SuppleBodyId body, size_t* out_count);
SuppleStatus supple_world_element_count(const SuppleWorld* world, SuppleBodyId body, size_t* out_count);
/* The triangles to draw: three vertex indices each, outward counter-clockwise, into a buffer of `capacity` integers. */
SuppleStatus supple_world_triangle_count(const SuppleWorld* world, SuppleBodyId body, size_t* out_count);
SuppleStatus supple_world_triangles(const SuppleWorld* world, SuppleBodyId body, int32_t* vertices, size_t capacity);

/* Hash of everything that moves: equal hashes, equal bits. */
SuppleStatus supple_world_hash(const SuppleWorld* world, uint64_t* out_hash);

#ifdef __cplusplus
}
#endif
#endif
