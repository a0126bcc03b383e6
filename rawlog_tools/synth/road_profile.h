#pragma once
#include <vector>

#include "carrier.h"
#include "lane.h"

namespace delio::synth {
/** How the vehicle drives on a kind of road. */
struct DrivingStyle {
    double slowest_m_s, fastest_m_s;  //!< of the speeds at which it cruises
    double maxYawRate_rad_s;
    double movingStart;    //!< how likely the drive begins in full motion
    double stopSpacing_m;  //!< about one stop of some seconds in so many metres; 0: none
};

/** Profile of a road: lanes, cross-section, marks and adjacent land. Both sides are equal; `away`
 *  is the distance from the centre line. */
struct RoadProfile {
    struct Corner {
        double away_m, height_m;
    };
    struct Band {
        double until_m, reflectivity;
    };
    struct Mark {
        double away_m, width_m;   //!< its middle
        double dash_m, period_m;  //!< equal: a line without gaps
    };
    struct Wave {
        double amplitude_m, length_m;
    };
    /** The whole world rises between two places on the x axis: floors of a house. */
    struct Ramp {
        double fromX_m, toX_m, rise_m;
    };

    std::vector<Lane> lanes;      //!< the vehicle's own is the first
    std::vector<Corner> section;  //!< from the centre line outwards; level beyond the last
    std::vector<Band> bands;
    std::vector<Mark> marks;
    double half_m;                //!< beyond, the land's coarser triangles begin
    double landReach_m;           //!< where the world ends
    double landStep_m;            //!< between the land's vertices near the road
    std::vector<Wave> waves;      //!< hills, settling, and what one feels in the seat: at most 8
    double grade;                 //!< the whole world slopes along +x
    double bank_m;                //!< the land beside the road rises or falls by so much ...
    double bankFrom_m, bankTo_m;  //!< ... between these
    double roughness_m;           //!< of the land, at the distance between the points of a scan
    DrivingStyle style;
    Carrier carrier;          //!< the vehicle, unless the sensor is hand-held
    std::vector<Ramp> ramps;  //!< the one after the other along x
    /** Where no cars drive people walk, at these sides of the centre line; at 0: along with the
     *  sensor, before and behind it. */
    std::vector<double> footways;

    double height(double away_m) const;
    double reflectivity(double s, double away_m) const;
    /** Offsets of the road mesh's vertices from the centre line. */
    std::vector<double> columns() const;
};

/** Two lanes with parking strips, kerbs and sidewalks. */
RoadProfile urbanProfile();
/** The same; round a block the turns are tighter. */
RoadProfile blockProfile();
/** Two lanes without kerbs between fields on slopes. */
RoadProfile ruralProfile();
/** Three lanes and a hard shoulder in each direction; the centre line is in the middle of the
 *  median. */
RoadProfile highwayProfile();
/** Two lanes and walkways on an even grade. */
RoadProfile tunnelProfile();
/** A track of two ruts over uneven ground. */
RoadProfile forestProfile();
/** Level floors; their ramps are the floor plan's. */
RoadProfile indoorProfile();
}  // namespace delio::synth
