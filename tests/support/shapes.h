#pragma once

#include <span>

#include <Eigen/Core>

#include "core/mesh/triangle_mesh.h"

/// Meshes with known properties. Closed ones are oriented outwards; open ones as said.
namespace ccst::shapes {

// Closed.

/// Regular, edges 2 sqrt(2), vertices on alternate corners of [-1, 1]^3. 4 faces.
TriangleMesh Tetrahedron();
/// [-1, 1]^3 with 12 faces.
TriangleMesh Cube();
/// Icosahedron divided `levels` >= 0 times, vertices on the sphere. 20 * 4^levels faces.
TriangleMesh Icosphere(int levels, double radius = 1.0);
/// `rows` >= 2 bands of latitude, `columns` >= 3 of longitude: thin triangles at the poles.
TriangleMesh UvSphere(int rows, int columns, double radius = 1.0);
/// Around the z axis; `around` >= 3 quads along the large circle, `across` >= 3 along the small.
TriangleMesh Torus(double large_radius, double small_radius, int around, int across);
/// A plate with `holes` >= 0 square holes, that is of this genus: boundary of unit cubes, each
/// triangle divided `levels` times, then smoothed `smoothing` times. Genus 2: a double torus.
TriangleMesh PlateWithHoles(int holes, int levels, int smoothing = 0);

// With boundary.

/// Side of a cylinder around the z axis, z in [0, height]; outwards. Two loops.
TriangleMesh Cylinder(double radius, double height, int around, int along);
/// [0, width] x [0, height] in the plane z = 0, facing +z.
TriangleMesh PlaneGrid(double width, double height, int columns, int rows);
/// z = x^2 - y^2 over [-1, 1]^2, facing +z. `cells` x `cells` quads.
TriangleMesh Saddle(int cells);
/// A sphere without the cap around +z whose polar angle is under `hole_angle` [radian], in
/// (0, pi); area 2 pi radius^2 (1 + cos(hole_angle)) in the limit. One loop.
TriangleMesh SphereWithHole(double hole_angle, int rows, int columns, double radius = 1.0);
/// One triangle in the plane z = 0.
TriangleMesh SingleTriangle();

// Made from others.

/// The meshes side by side in one, faces in the order given.
TriangleMesh DisjointUnion(std::span<const TriangleMesh> meshes);
/// Each position x becomes scale * x + offset; `scale` > 0.
TriangleMesh Moved(TriangleMesh mesh, const Eigen::Vector3d& offset, double scale = 1.0);
/// Every face split in four at the midpoints of its sides; faces of one face stay together.
TriangleMesh Subdivided(const TriangleMesh& mesh);
/// Every face with three vertices of its own, bitwise equal to those it had.
TriangleMesh Unwelded(const TriangleMesh& mesh);
/// `count` vertices of no face put in front; face indices move up.
TriangleMesh WithIsolatedVertices(const TriangleMesh& mesh, int count);
/// Face `face` turned over.
TriangleMesh WithFlippedFace(TriangleMesh mesh, int face);

// Not oriented 2-manifolds.

/// Three triangles at one edge, (0, 1).
TriangleMesh ThreeFins();
/// Two tetrahedra that share vertex 0.
TriangleMesh TetrahedraSharingVertex();
/// Moebius strip around the z axis; `around` >= 3, `across` >= 1. No orientation exists.
TriangleMesh MoebiusStrip(int around, int across);

}  // namespace ccst::shapes
