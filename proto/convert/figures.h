#pragma once

#include "ccst/v1/sampling_service.pb.h"
#include "core/analysis/sample_figures.h"
#include "core/quality/sample_mesh_quality.h"

namespace ccst {

v1::Curve ToProto(const analysis::Curve& curve);

/// Sets the fields that tell the angles of a sample mesh, at least one triangle.
void AddFigures(const quality::AngleFigures& figures, v1::AnalyzeJobResponse& response);

/// Sets the fields that only the analysis of the samples on their surface gives: curves, what
/// follows from them, and the figures of Voronoi cells and bonds.
void AddFigures(const analysis::SampleFigures& figures, v1::AnalyzeJobResponse& response);

}  // namespace ccst
