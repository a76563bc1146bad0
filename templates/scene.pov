// {{ title }}
// A scene that shows off {{ stem }}.inc. Render it with: povray {{ stem }}.ini
// Made by lichtenberg {{ version }}. Edit it freely: an edited file is not overwritten.
#version 3.7;
global_settings { assumed_gamma 1.0 }

camera {
  {{ camera.kind }}
  location {{ camera.location }}
{% if camera.angle %}
  right x*image_width/image_height
  angle {{ camera.angle }}
{% else %}
  right x*{{ camera.width }}
  up y*{{ camera.width }}*image_height/image_width
{% endif %}
  look_at {{ camera.look_at }}
}
{% for light in lights %}
light_source {
  {{ light.location }}, rgb {{ light.colour }}
{% if light.parallel %}
  parallel point_at <0, 0, 0>
{% endif %}
{% if light.across %}
  area_light x*{{ light.across }}, z*{{ light.across }}, 5, 5 adaptive 1 circular orient
{% endif %}
{% if not light.shadow %}
  shadowless
{% endif %}
}
{% endfor %}
sky_sphere {
  pigment {
    gradient y
    color_map { [0.5 rgb {{ sky.horizon }}] [1 rgb {{ sky.zenith }}] }
    scale 2 translate -1
  }
}
{% if ground %}
// The ground fades into the horizon.
plane {
  y, {{ ground.height }}
  texture {
    spherical
    texture_map {
      [0 pigment { rgb {{ sky.horizon }} } finish { ambient 0 diffuse 0 emission 1 }]
      [0.7 pigment { rgb {{ ground.colour }} } finish { ambient {{ ground.ambient }} diffuse {{ ground.diffuse }} }]
    }
    scale {{ ground.reach }}
  }
}
{% endif %}
{% if inline %}
#declare {{ prefix }}_Inline = yes;
{% endif %}
#include "{{ stem }}.inc"
{% if not inline %}
{% for object in objects %}
object { {{ object.id }} translate {{ object.id }}_Foot }
{% endfor %}
{% endif %}
