#pragma once
#include <iosfwd>
#include <map>
#include <string>

#include "delio/graph/pose_graph_options.h"
#include "delio/prediction.h"
#include "delio/rotation/normals.h"
#include "delio/rotation/outlier_removal.h"
#include "delio/rotation/pattern_registration.h"
#include "delio/scan/preprocess.h"
#include "delio/translation/line_cloud.h"
#include "delio/translation/line_registration.h"
