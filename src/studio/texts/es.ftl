# Las palabras que muestra Studio. Las mismas claves están en en.ftl.

window-title = Ademán Studio

## Barra de herramientas

button-pause = Pausar
button-resume = Reanudar
button-recenter = Recentrar
button-zero = Poner a cero
hint-pause = Suelta todas las teclas y no envía nada más, o continúa (P)
hint-recenter = Coloca los tableros bajo la punta del índice (C)
hint-zero = Relaje antes la mano: sus ángulos actuales pasan a ser los de reposo (Z)
menu-view = Vista
view-eye = Desde los ojos
view-above = Desde arriba
view-side = De lado
view-bones = Huesos y articulaciones
view-dark = Oscuro
panel-sensors = Sensores
panel-scope = Osciloscopio

## Vista 3D

hint-camera = arrastrar: girar · botón derecho: desplazar · rueda: acercar · 1 2 3: vistas

## Sensores

channel-column = Canal
channel-joint = Articulación
channel-count = Valor
channel-angle = Ángulo
channel-at-end = En el extremo de su rango
channel-unchanged = Sin cambios desde hace 10 s
channel-none = Esta fuente no tiene canales: mide ángulos o posiciones.
channel-no-reading = Aún no ha llegado ninguna lectura.
stats-source = Fuente
stats-output = Salida
stats-rate = Lecturas por segundo
stats-accepted = Aceptadas
stats-dropped = Descartadas
stats-losses = Desconexiones
stats-stalls = Interrupciones

## Osciloscopio

scope-angles = Ángulos
scope-rows = Filas
scope-heights = Altura de las yemas
scope-latency = Latencia
scope-presses = Pulsaciones por dedo
scope-events = Teclas enviadas
scope-hold = Congelar la gráfica
scope-latest = Últimos 30 s
scope-hint = rueda: ampliar · arrastrar: mover · doble clic: últimos 30 s
scope-plot = Gráfica de ángulos, yemas y pulsaciones en el tiempo

## Línea de estado

message-ended = La sesión ha terminado. No queda ninguna tecla pulsada.

## Grabación

recording-play = Reproducir
recording-pause = Pausa
recording-first = Primera lectura
recording-back = Una lectura atrás
recording-on = Una lectura adelante
recording-last = Última lectura
recording-position = Posición
recording-speed = Velocidad
recording-hint = Izquierda, derecha: una lectura; con Mayús: 1 s; Inicio, Fin; Espacio: reproducir o pausar
recording-step = lectura { $index } de { $count }
recording-loading = Leyendo la grabación: { $count } lecturas hasta ahora
recording-cut = La grabación no está completa: { $reason }. Se muestra todo lo anterior.
recording-part = Fragmento
recording-from = Desde aquí
recording-to = Hasta aquí
recording-file = Archivo
recording-export = Exportar el fragmento
recording-exporting = Escribiendo…
recording-exported = { $count } lecturas están en { $file }
recording-replace = { $file } ya existe.
recording-replace-yes = Reemplazarlo
recording-replace-no = Conservarlo
recording-compare = Comparar con la distribución
recording-compare-go = Comparar
recording-compare-close = Cerrar
recording-comparing = Comparando…
recording-same = iguales: { $count }
recording-only-a = solo A: { $count }
recording-only-b = solo B: { $count }
recording-rows = Pulsaciones de ambas distribuciones a lo largo de la grabación; un clic va a ese momento
