# Las palabras que muestra Studio. Las mismas claves están en en.ftl.

window-title = Ademán Studio

## Barra de herramientas

button-pause = Pausar
button-resume = Reanudar
button-recenter = Recentrar
button-zero = Poner a cero
hint-pause = Suelta todas las teclas y deja de enviar, o reanuda la sesión
hint-recenter = Coloca los tableros bajo la punta del índice
hint-zero = Relaje antes la mano: sus ángulos actuales pasan a ser los de reposo
hint-view = Cambia la vista 3D
button-fingertip = Ratón como dedo
hint-fingertip = Pulsa teclas y arrastra controles de la vista 3D con el ratón; nada se envía a otros programas
hint-panel = Muestra u oculta este panel
menu-view = Vista
view-eye = Desde los ojos
view-above = Desde arriba
view-side = De lado
view-bones = Huesos y articulaciones
view-opaque = Mano opaca
view-trails = Estelas de las yemas
view-reach = Alcance
menu-open = Abrir distribución
layouts-hint = Se suelta todo y la sesión sigue con otra distribución
layouts-recent = Abiertas antes
layouts-file = Archivo de una distribución
layouts-button = Abrir
layouts-shipped = Con el programa
layouts-missing = { $file } ya no existe; se quitó de la lista
menu-devices = Dispositivos
devices-hint = Fuente, guante, persona y salidas
devices-words = Después de elegir se suelta todo; luego la sesión sigue con lo elegido.
devices-unsaved = El guante tiene cambios sin guardar, que se perderían. Guárdelos o deshágalos en el panel «Sensores» y elija otra vez.
devices-use = Usar
devices-source = Fuente
devices-search = Buscar otra vez
devices-silent = { $port }: no llega nada. Encienda el guante y busque otra vez.
devices-recordings = Grabaciones, las más recientes primero:
devices-recording = Grabación
devices-recording-hint = Archivo, como sesion.mcap
devices-uri = Otra fuente
devices-uri-hint = Como después de --source: udp:127.0.0.1:9000
devices-keys = Una fuente de la red solo apunta hasta que permita teclas aquí.
devices-glove = Guante
devices-glove-own = El que la fuente necesita
devices-glove-file = o un archivo
devices-person = Persona
devices-person-none = Ninguna
devices-person-file = o un archivo
devices-arm = Brazo
devices-arm-person = El de la persona
devices-arm-measured = Con las medidas de la configuración
devices-arm-file = o un archivo
devices-output = Salidas
devices-output-hint = o varias, o con un argumento, como después de --output
devices-output-paused = Una salida elegida aquí empieza en pausa: Reanudar la deja escribir.
devices-profile = Perfil
devices-setup = Configuración
devices-setup-hint = Archivo, en lugar de todo lo anterior
devices-waiting = La sesión siguiente no ha empezado
devices-waiting-words = Su fuente o sus salidas no están abiertas. Puede que el escritorio pregunte si Ademán puede escribir. Hasta entonces no se pulsa nada. Con P empieza en pausa.
menu-hand = Mano simulada
hand-speed = Velocidad
hand-noise = Ruido de sus sensores
hand-noise-hint = Desviación típica: cuentas de un guante, milímetros de una cámara
hand-person = Persona
hand-person-own = Como al inicio
hand-person-file = Archivo de una persona
hand-person-open = Abrir
menu-settings = Ajustes
menu-help = Ayuda
theme-system = Colores del sistema
theme-light = Claro
theme-dark = Oscuro
theme-contrast = Alto contraste
scale-larger = Más grande (Ctrl+Más)
scale-smaller = Más pequeño (Ctrl+Menos)
scale-normal = Tamaño normal (Ctrl+0)
sound-clicks = Clic en cada pulsación
sound-volume = Volumen de los clics
panel-sensors = Sensores
panel-scope = Osciloscopio
panel-space = Vista 3D
panel-recording = Grabación
panel-toolbar = Barra de herramientas
panel-status = Línea de estado
panel-calibration = Calibración
panel-editor-error = Editor de distribuciones
panel-editor-bar = Herramientas del editor
panel-editor-problems = Problemas
panel-editor-form = Propiedades
panel-editor-canvas = Distribución
panel-word = Panel

## Ayuda

help-tour = Visita guiada
help-guide = La guía viene con el código fuente:
keys-title = Teclas
keys-next-panel = Panel siguiente
keys-previous-panel = Panel anterior
keys-orbit = Girar la vista 3D (F6 la selecciona)
keys-pan = Desplazar la vista 3D
keys-zoom = Acercar o alejar la vista 3D o el osciloscopio
keys-tab = Control siguiente o anterior
keys-operate = Accionar el control seleccionado
keys-escape = Cerrar un menú o una ventana
keys-palette = Órdenes del editor de distribuciones
keys-scale = Más grande, más pequeño
keys-normal-scale = Tamaño normal

## Visita guiada

tour-step = Paso { $step } de { $count }
tour-next = Siguiente
tour-back = Atrás
tour-skip = Saltar la visita
tour-done = Terminar
tour-view = La mano y sus tableros
tour-view-words = La vista 3D muestra la mano tal como Ademán la interpreta. Un anillo sobre el tablero se encoge cuando se acerca un dedo, y la tecla pulsada se hunde y se ilumina. Arrastre para girar, use la rueda para acercarse o pulse 1, 2 o 3.
tour-pause = Pausar en cualquier momento
tour-pause-words = El primer botón, o la tecla P, suelta todas las teclas y no envía nada hasta que reanude. Para pausar desde cualquier programa, indique teclas de emergencia en su archivo de configuración, por ejemplo las dos teclas Ctrl: panic_keys: ["ControlLeft", "ControlRight"].
tour-sensors = Sensores
tour-sensors-words = El panel de la derecha muestra cada sensor y el ángulo que mide. Los signos ×, ▲ y ▼ avisan de un cable roto, y ■ de un sensor bloqueado. Si los ángulos no siguen a su mano, calibre el guante en la pestaña Calibración.
tour-layout = Su propia distribución
tour-layout-words = La pestaña Distribución muestra la distribución desde arriba: arrastre sus teclas y asígneles funciones. Al guardar una que viene con el programa se escribe una copia. Abra la suya con ademan studio --layout ARCHIVO: cada vez que se guarda, aquí o en un editor de texto, la mano escribe sobre ella.
tour-output = Conectar una salida con seguridad
tour-output-words = No se escribe nada en otros programas hasta que un archivo de configuración indique una salida o usted elija una en Dispositivos. La línea inferior siempre dice cuál es. Pruebe primero aquí la distribución, compruebe la pausa y las teclas de emergencia, y ejecute ademan doctor antes de conectar una.

## Vista 3D

typed-hint = El texto hasta ahora, con Retroceso aplicado
candidate-hint = Toma esta palabra en lugar de la que se escribe
hint-fingertip-camera = pulsar y arrastrar controles · al lado o con Mayús: girar · botón derecho: desplazar · nada se envía a otros programas
hint-camera = arrastrar: girar · botón derecho: desplazar · rueda: acercar · 1 2 3: vistas

## Sensores

channel-joint = Articulación
channel-count = Valor
channel-angle = Ángulo
channel-none = Esta fuente no tiene canales: mide ángulos o posiciones.
channel-no-reading = Aún no ha llegado ninguna lectura.
stats-source = Fuente
stats-source-simulated = mano simulada
stats-source-mouse = ratón
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
scope-not-sent = Otro programa no envía ángulos de articulaciones ni latencias

## Línea de estado

state-starting = Iniciando
state-running = En marcha
state-paused = En pausa
state-stalled = Sin lecturas
state-unusable = Sin lecturas útiles: { $reason }
state-stopped = Terminada
typing-nowhere = No se escribe nada en otros programas
typing-suppressed = En pausa: no se escribe nada en otros programas
typing-into = Escribe en otros programas: { $output }

## Visor

headset-title = Visor
headset-connected = Visor { $name } en { $address }
headset-none = Ningún visor conectado
headset-hint = Enlace para el visor, y sus teclas
headset-open = Escanee el código con el visor, o abra este enlace en su navegador. Es una contraseña: quien lo tiene puede mover su puntero.
headset-certificate = El navegador avisa del certificado porque lo ha creado este ordenador; acepte el aviso una vez.
headset-code = Código QR del enlace
headset-show = Mostrar el enlace
headset-hide = Ocultar el enlace
headset-keys = Hasta que permita teclas aquí, solo apunta.
headset-allow = Permitir teclas
headset-forbid = Prohibir teclas
headset-allow-hint = Lo suelta todo; después todas las fuentes de la sesión pulsan teclas hasta que termine o siga otro emisor
headset-forbid-hint = Lo suelta todo; después todas las fuentes de la sesión solo apuntan

## Avisos de la sesión

notice-disarmed = En pausa: mantenga la mano un momento lejos de todas las teclas para activar
notice-armed = Activado: los toques se envían a otros programas
notice-armed-nowhere = Activado: no se escribe nada en otros programas
notice-stalled = Sin lecturas útiles: se ha soltado todo
notice-output-stalled = El programa o su salida no han respondido a tiempo: se ha soltado todo. El equipo está demasiado ocupado o el programa estuvo detenido
notice-paused = En pausa: se ha soltado todo
notice-paused-by-layout = En pausa por una tecla o un gesto de la distribución, que también reanuda: se ha soltado todo
notice-paused-by-rate = En pausa: más pulsaciones de las que hace una persona (max_presses_per_second en la configuración); se ha soltado todo
notice-left-lost = No se ve la mano izquierda: se ha soltado lo que pulsaba y no toca nada
notice-right-lost = No se ve la mano derecha: se ha soltado lo que pulsaba y no toca nada
notice-left-stuck = El seguimiento de la mano izquierda ha repetido exactamente las mismas posiciones durante 5 s: se ha soltado lo que pulsaba la mano, que no toca nada hasta que las posiciones cambien. Si no cambian al mover la mano, revise la cámara y reinicie el seguimiento
notice-right-stuck = El seguimiento de la mano derecha ha repetido exactamente las mismas posiciones durante 5 s: se ha soltado lo que pulsaba la mano, que no toca nada hasta que las posiciones cambien. Si no cambian al mover la mano, revise la cámara y reinicie el seguimiento
notice-left-too-fast = La mano izquierda ha pulsado más deprisa que el límite: se ha soltado lo que pulsaba y no toca nada hasta reanudar la sesión
notice-right-too-fast = La mano derecha ha pulsado más deprisa que el límite: se ha soltado lo que pulsaba y no toca nada hasta reanudar la sesión
notice-left-found = Se vuelve a ver la mano izquierda
notice-right-found = Se vuelve a ver la mano derecha
notice-sensors-work = Los sensores de todos los dedos funcionan de nuevo
notice-watchdog-lost = El proceso vigilante ha terminado o no responde: se ha soltado todo

message-ended = La sesión ha terminado. No queda ninguna tecla pulsada.

## Grabación

recording-play = Reproducir
recording-pause = Pausa
recording-first = Primera lectura
recording-back = Lectura anterior
recording-on = Lectura siguiente
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
recording-exported = { $count ->
        [one] 1 lectura está en { $file }
       *[other] { $count } lecturas están en { $file }
    }
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

## Nombres de articulaciones

finger-thumb = Pulgar
finger-index = Índice
finger-middle = Medio
finger-ring = Anular
finger-little = Meñique
finger-of-left = izquierda
finger-of-right = derecha
joint-shoulder-z = Hombro, primer eje
joint-shoulder-y = Hombro, segundo eje
joint-shoulder-x = Brazo, giro
joint-elbow = Codo
joint-forearm = Antebrazo, giro
joint-second-bone = Antebrazo, segundo hueso
joint-wrist-sideways = Muñeca, lateral
joint-wrist-bend = Muñeca, flexión
joint-base-sideways = base, lateral
joint-base = base
joint-knuckle = nudillo
joint-sideways = lateral
joint-middle = articulación media
joint-end = articulación final

## Sensores: canales

sensor-channels = Canales
sensor-bar = Señal
sensor-bar-hint = Triángulos: límites de la articulación. Sombreado: intervalo calibrado.
sensor-channel-hint = Canal { $channel } { $label }: selecciónelo para cambiar sus valores
sensor-count-name = { $count ->
        [one] Canal { $channel }: 1 cuenta
       *[other] Canal { $channel }: { $count } cuentas
    }
sensor-no-count = Canal { $channel }: sin valor
sensor-missing = Sin valor
sensor-low-end = En su extremo inferior: revise el cable
sensor-high-end = En su extremo superior: revise el cable
sensor-stuck = Inmóvil mientras el dedo se dobla

## Sensores: valores de un canal

value-gain = Intervalo completo
value-gain-hint = Cambio del ángulo en todas las cuentas del sensor (full_scale_rad en el archivo del guante)
value-offset = Cuenta a 0°
value-offset-hint = Cuenta de la articulación recta (menos offset_counts en el archivo del guante)
value-inverted = Invertido
value-inverted-hint = El ángulo baja mientras la cuenta sube, como con cables cruzados
value-range = Intervalo
value-range-hint = Cuenta menor y mayor de esta mano; --learn-ranges puede ampliarlo (range_counts en el archivo del guante)
value-plot = Graficar abajo

## Sensores: archivo del guante

glove-save = Guardar
glove-undo = Deshacer
glove-redo = Rehacer
glove-undo-hint = Deshacer el último cambio del guante
glove-redo-hint = Repetir el cambio deshecho
glove-close-question = La calibración del guante no está guardada.
glove-unsaved = ● sin guardar
glove-replace = { $file } ya existe. ¿Reemplazarlo? El archivo actual se conserva como { $backup }.
button-replace = Reemplazar
button-cancel = Cancelar

## Sensores: fuente

stats-state = Estado
stats-dropped-presses = Pulsaciones perdidas por la salida
stats-suppressed = Eventos suprimidos
stats-rejected = Rechazadas
stats-latency = Latencia p50 / p99 / máx.
front-turns = { $turns } vueltas

## Sensores: filtro

filter-title = Filtro
filter-one-euro = 1-Euro
filter-average = Promedio recursivo
filter-off = Ninguno
filter-cutoff = Corte en reposo
filter-cutoff-hint = Menor: menos temblor, más retraso en reposo (min_cutoff_hz)
filter-beta = Aumento con la velocidad
filter-beta-hint = Mayor: menos retraso en movimiento (beta, en Hz por rad/s)
filter-joint = Articulación
filter-raw = antes
filter-filtered = después del filtro
filter-lag = retraso { $ms } ms
filter-no-lag = mueva la articulación para medir el retraso
filter-plot = Ángulo antes y después del filtro, últimos 5 s
filter-copy = Copiar
filter-copy-hint = Copiar el ajuste para el archivo de configuración

## Calibración guiada

workspace-hand = Mano
workspace-calibration = Calibración
calibration-title = Calibración guiada de { $glove }
calibration-intro = Adopte cada pose como en la imagen y manténgala un segundo. Mientras tanto la sesión está en pausa y no se escribe nada. Ningún archivo cambia hasta que guarde.
calibration-start = Empezar
calibration-fingers = También cada dedo por separado
calibration-fingers-hint = Cinco poses más, que encuentran los sensores intercambiados de dos dedos
calibration-demo = Ver a una persona simulada
calibration-demo-hint = Una persona simulada con un guante sin calibrar adopta las poses
calibration-simulated = La mano de esta sesión es simulada y no adopta poses. Elija un guante en Dispositivos o mire a una persona simulada.
calibration-is-demo = Demostración con una persona simulada
calibration-none = Esta fuente no necesita archivo de guante; no hay nada que calibrar.
calibration-pose = Pose { $number } de { $count }
calibration-prepare = Prepárese: { $seconds }
calibration-take = Adopte la pose
calibration-moving = No se mueva
calibration-holding = No se mueva …
calibration-done = Listo
calibration-repeat = Repetir (R)
calibration-skip = Saltar (S)
calibration-quit = Salir (Q)
calibration-repeat-hint = Tomar esta pose otra vez, o la anterior durante la cuenta atrás
calibration-above = desde arriba
calibration-below = desde abajo
calibration-side = de lado
calibration-score = Puntuación { $score } de 100
calibration-no-problem = Ningún sensor tiene problemas.
calibration-moved = El canal { $channel } sigue a otro dedo que en el archivo del guante: { $followed }, no { $stated }
calibration-matched = El resultado tiene estos sensores en los dedos a los que siguen.
calibration-unmatched = Un dedo tiene más sensores que en el archivo del guante, así que los canales no cambian: revise cables y conectores.
calibration-uncompared = No se han comparado los sensores de los dedos: se ha saltado una pose que dobla un solo dedo.
calibration-before = Antes
calibration-after = Después
calibration-use = Usar y guardar
calibration-use-hint = Usar el resultado ahora y guardarlo en { $file }
calibration-try = Usar sin guardar
calibration-failed = Sin calibración
glove-saved = Guardado en { $file }. Deshacer en el panel «Sensores» vuelve a los valores anteriores; guarde otra vez para escribirlos.
pose-rest = Apoye la mano relajada en la mesa
pose-flat = Apoye la palma y los dedos planos en la mesa, con los dedos y el pulgar juntos
pose-fist = Cierre el puño con fuerza, con el pulgar doblado sobre los dedos
pose-spread = Apoye la mano plana en la mesa y separe los dedos y el pulgar al máximo
pose-pinch = Toque la punta del pulgar con el índice, los demás dedos rectos
pose-elbow-straight = Estire el brazo, con los dedos rectos
pose-elbow-bent = Doble el codo en ángulo recto, con los dedos rectos
pose-wrist-up = Doble la muñeca hacia arriba al máximo, con los dedos rectos
pose-wrist-down = Doble la muñeca hacia abajo al máximo, con los dedos rectos
pose-wrist-in = Mano plana en la mesa: gírela hacia el pulgar al máximo
pose-wrist-out = Mano plana en la mesa: gírela hacia el meñique al máximo
pose-palm-up = Antebrazo en la mesa: gire la palma hacia arriba al máximo, con los dedos rectos
pose-palm-down = Apoye otra vez la mano plana en la mesa, con la palma hacia abajo
pose-thumb-bent = Doble solo el pulgar, los dedos rectos
pose-index-bent = Doble solo el índice, los demás rectos
pose-middle-bent = Doble solo el medio, los demás rectos
pose-ring-bent = Doble solo el anular, los demás rectos
pose-little-bent = Doble solo el meñique, los demás rectos

## Editor de distribuciones

editor-canvas = Tablero
editor-hint = clic, Mayús-clic o arrastrar: seleccionar · arrastrar una tecla: mover (Alt: libre) · botón derecho: desplazar · rueda: zoom · flechas: paso de cuadrícula (Mayús: 0,1 mm)
editor-hint-empty = «Añadir», en la barra, pone aquí una tecla u otro control
editor-save = Guardar
editor-save-hint = Escribir el archivo (Ctrl-S)
editor-save-as = Guardar como…
editor-save-as-hint = Escribir una copia con otro nombre y seguir con ella
editor-save-path = Archivo
editor-save-needs-name = Escriba el nombre de un archivo, no de una carpeta
editor-cancel = Cancelar
editor-saved = Guardado
editor-undo = Deshacer
editor-undo-hint = Deshacer el último cambio (Ctrl-Z)
editor-redo = Rehacer
editor-redo-hint = Repetir el último cambio deshecho (Ctrl-Y)
editor-add = Añadir
editor-new-sequence = Secuencia
editor-sequences = Secuencias
editor-add-step = Añadir paso
editor-step-kind = Tipo de paso
editor-step-earlier = Subir el paso
editor-name = Nombre
editor-duplicate = Duplicar
editor-duplicate-hint = Copiar lo seleccionado (Ctrl-D)
editor-delete = Eliminar
editor-delete-hint = Eliminar lo seleccionado (Supr)
editor-new-board = Tablero
editor-new-layer = Capa
editor-new-trigger = Disparador
editor-new-pointer = Puntero
editor-new-space = Objetivos en el espacio
editor-add-chord = Acorde de las teclas seleccionadas
editor-add-chord-hint = Seleccione al menos dos teclas del tablero
editor-add-target = Añadir un objetivo
editor-align-left = Alinear bordes izquierdos
editor-align-center = Alinear centros en profundidad
editor-align-right = Alinear bordes derechos
editor-align-far = Alinear bordes lejanos
editor-align-middle = Alinear centros a lo largo de la fila
editor-align-near = Alinear bordes cercanos
editor-distribute-x = Igualar espacios de izquierda a derecha
editor-distribute-y = Igualar espacios de cerca a lejos
editor-mirror-x = Reflejar izquierda y derecha
editor-mirror-y = Reflejar cerca y lejos
editor-snap = Ajustar
editor-snap-hint = Los bordes y centros de otras teclas, y la cuadrícula, atraen lo que se arrastra
editor-try = Probar al momento
editor-try-hint = La sesión usa el texto editado antes de guardarlo. Cada cambio válido suelta primero todas las teclas; un dedo dentro de una tecla debe salir de ella. Desactivado: la sesión vuelve al texto guardado.
editor-grid = Cuadrícula
editor-rulers = Reglas
editor-rulers-hint = Milímetros en los bordes superior e izquierdo, con el puntero y lo seleccionado
editor-fit = Ver todo
editor-fit-hint = Mostrar todo el tablero
editor-board = Tablero { $number }
editor-no-problems = Sin problemas
editor-unbalanced = Los paréntesis del texto no están equilibrados; corrija el primer problema en el texto, o deshaga el cambio
editor-layout = Distribución
editor-pointer = Puntero
editor-boards = Tableros
editor-layers = Capas
editor-chords = Acordes
editor-triggers = Disparadores
editor-spaces = Objetivos en el espacio
editor-nothing-selected = No hay nada seleccionado. Haga clic en una tecla o arrastre alrededor de varias.
editor-several-selected = { $count } partes seleccionadas
editor-remove-field = Usar el valor por omisión
editor-optional = Opciones con valor por omisión
editor-binding = Asignación
editor-search = Buscar una tecla
editor-press-key = Pulsar la tecla
editor-press-key-hint = Tomar la siguiente tecla que se pulse en el teclado
editor-pressing = Pulse una tecla; clic para cancelar
editor-unbind = Quitar
editor-changed-outside = Otro programa ha cambiado el archivo, en lugares que también se han cambiado aquí.
editor-merged = Otro programa ha cambiado el archivo; sus cambios también están en este texto.
editor-keep-mine = Conservar lo mío
editor-take-theirs = Tomar el archivo
editor-close-question = La distribución tiene cambios sin guardar.
editor-close-save = Guardar y cerrar
editor-close-discard = Cerrar sin guardar
editor-close-cancel = Seguir editando
editor-cannot-open = La distribución no se puede abrir en el editor
editor-recovered = Se ha encontrado trabajo sin guardar de otra sesión.
editor-open-elsewhere = Otro Studio tiene abierta esta distribución: cualquiera puede guardar, y el otro combina los cambios o pregunta
editor-restore = Recuperar
editor-discard = Descartar
workspace-layout = Distribución
editor-slot-base = Pulsada
editor-slot-hold = Mantenida
editor-slot-layer = Capa
editor-command = Orden
editor-multitap = Una de
editor-clutch = Detener el puntero
editor-precision = Frenar el puntero
editor-no-action = Sin acción
editor-width = Ancho
editor-depth = Fondo
editor-diameter = Diámetro
editor-angle = Ángulo
editor-reloaded = Otro programa ha cambiado el archivo; se ha vuelto a leer.
editor-replace = Reemplazar el archivo
editor-row = Fila
editor-option = Opción
editor-target = Objetivo
editor-chord = Acorde

## Superposición

overlay-title = Superposición de Ademán
overlay-opacity = Opacidad
overlay-place = Lleve esta ventana al lugar de la superposición y ciérrela.
overlay-opaque = la superposición es pequeña y opaca, porque en este escritorio no hay un compositor; inicie uno, por ejemplo picom, para que sea transparente
overlay-window-only = la superposición es una ventana corriente, porque este escritorio no deja ninguna ventana por encima de las demás: elíjalo en el menú de la ventana, o instale Xwayland

# Editor de distribuciones: problemas, portapapeles, repetición, paleta
editor-cannot-run = Ninguna sesión puede usar esta distribución hasta que se corrijan sus errores.
editor-save-anyway = Guardar de todos modos
editor-saved-with-errors = Guardado con errores: ninguna sesión puede usarlo aún
editor-copied = Copiado como texto de una distribución
editor-not-copied = Al portapapeles van controles, tableros, disparadores y objetivos, nada más de una distribución
editor-copy = Copiar
editor-cut = Cortar
editor-paste = Pegar
editor-select-all = Seleccionar todo
editor-zoom-selection = Mostrar lo seleccionado
editor-snap-to-grid = Mover lo seleccionado a la cuadrícula
editor-nudge-left = Mover a la izquierda
editor-nudge-right = Mover a la derecha
editor-nudge-up = Mover hacia arriba en la imagen
editor-nudge-down = Mover hacia abajo en la imagen
editor-repeat = Repetir
editor-repeat-now = Repetir en cuadrícula
editor-columns = Columnas
editor-rows = Filas
editor-pitch-x = A la derecha
editor-pitch-y = Hacia delante
editor-repeat-arc = Repetir en arco
editor-repeat-arc-hint = Las copias giran con el arco. Su centro queda hacia la persona; con un radio negativo, al otro lado.
editor-arc-count = Cantidad
editor-arc-step = Ángulo entre piezas
editor-arc-radius = Radio
editor-palette = Órdenes
editor-palette-hint = Parte de un nombre
editor-palette-none = Ninguna orden coincide
editor-mixed = varios
editor-open = Abrir…
editor-open-hint = Abrir un archivo, una distribución vacía o una copia de una que viene con el programa (Ctrl-O)
editor-open-title = Abrir una distribución
editor-open-empty = Distribución vacía
editor-open-name = Archivo, o parte del nombre de una distribución que viene con el programa
editor-open-unsaved = Esta distribución tiene cambios sin guardar. Se conservan y se ofrecen cuando se abra de nuevo.
editor-open-unkept = La distribución tiene cambios sin guardar que no se pueden conservar y se perderían. Guárdelos o deshágalos en la pestaña «Distribución» y elija otra vez.
editor-export = Escribir una imagen (SVG)
editor-export-png = Escribir una imagen de píxeles (PNG)
editor-export-pdf = Escribir una página para imprimir (PDF)
editor-copy-link = Copiar enlace (compartir la distribución)
editor-link-copied = El enlace está en el portapapeles; abre la distribución en la página de `ademan serve`
editor-export-svg-only = esta ventana no hace imágenes PNG ni PDF; escriba una imagen SVG
editor-exported = La imagen está escrita junto a la distribución
editor-exported-here = La imagen está escrita en la carpeta en la que se inició Studio, pues la distribución no tiene archivo
editor-export-exists = la imagen existe y no se sobrescribe; muévala a otro sitio

# Editor de distribuciones: todos los tableros
editor-plan = Todos los tableros
editor-plan-tab-hint = Todos los tableros y objetivos en el espacio donde están, con la mano en reposo
editor-plan-canvas = Plano de todos los tableros
editor-plan-hint = arrastrar: mover (Alt: libre) · asas redondas: girar, inclinar, curvar · doble clic: abrir un tablero · botón derecho: desplazar · rueda: zoom
editor-plan-free-hint = arrastrar: mover en el plano de la imagen (Alt: libre) · botón derecho, Ctrl-flechas: girar la vista · botón central: desplazar · rueda: zoom
editor-view-front = De frente
editor-view-free = Vista libre

## Primer inicio

first-title = Ademán Studio: primer inicio
first-source = Lo que se encontró
first-hand = Qué mano
first-layout = Distribución
first-start = Listo
first-no-port = No hay ningún puerto serie. Conecte el guante y vuelva a iniciar Studio.
first-listening = { $port }: escuchando unos segundos …
first-recognized = { $port } tiene un dispositivo:
first-unknown = { $bytes ->
        [one] { $port }: 1 byte de ningún dispositivo conocido. Compruebe su velocidad.
       *[other] { $port }: { $bytes } bytes de ningún dispositivo conocido. Compruebe su velocidad.
    }
first-silent = { $port }: no llega nada. Encienda el guante y vuelva a iniciar Studio.
first-closed = { $port }: no se puede escuchar: { $reason }
first-camera = Cámara { $camera }: sigue su mano con la orden { $command } en un terminal.
first-simulated = Mano simulada
first-simulated-words = Usa sola cada control de la distribución, para que vea lo que ocurre. No se escribe ningún archivo.
first-hand-words = La mano que se mide:
first-right = Mano derecha
first-left = Mano izquierda
first-layout-words = Propuesta para este sensor y esta mano: { $layout }
first-mirrored = Imagen reflejada de { $layout }, en un archivo propio
first-summary-source = Fuente
first-summary-hand = Mano
first-summary-layout = Distribución
first-calibrate = Calibrar primero el guante: algunas poses, cerca de un minuto
first-keep = Guardar como configuración de cada ejecución sin otra
first-begin = Iniciar
first-skip = Saltar
first-skip-all = Saltar todo: mano simulada

## El laboratorio
workspace-lab = Laboratorio
panel-watched = Persona del laboratorio
lab-controls = Condiciones
lab-results = Cifras
lab-board = Tablero con los controles fallados
lab-intro = Personas simuladas usan la distribución del editor, guardada o no, con todo el programa. Nada se escribe en otros programas. docs/lab.md explica de qué están hechas las personas.
lab-people = Personas
lab-phrases = Frases de cada una
lab-corpus = Textos
lab-tier = Errores
lab-own-errors = los suyos
lab-source = Sensor
lab-decoder = Decodificador de texto
lab-seed = Semilla
lab-compare = Comparar con
lab-compare-nothing = nada
lab-compare-saved = la distribución guardada
lab-compare-file = otra distribución:
lab-compare-name = Nombre o ruta de la otra distribución
lab-saved = guardada
lab-run = Ejecutar
lab-run-hint = Evalúa la distribución en hilos propios
lab-run-invalid = La distribución tiene errores; la pestaña Distribución los muestra
lab-run-unnamed = Indique la distribución con la que comparar
lab-cancel = Cancelar
lab-progress = { $all ->
        [one] { $done } de 1 persona
       *[other] { $done } de { $all } personas
    }
lab-no-results = Todavía no hay resultados
lab-stale = La distribución ha cambiado desde esta ejecución
lab-conditions = { $people ->
        [one] 1 persona
       *[other] { $people } personas
    }, { $phrases ->
        [one] 1 frase
       *[other] { $phrases } frases
    } de cada una de { $corpus }; errores: { $tier }; sensor { $source }; decodificador { $decoder }; semilla { $seed }. Simulado; los intervalos son del 95 %, de poblaciones remuestreadas.
lab-wpm = Palabras correctas/min
lab-cer = Caracteres erróneos, %
lab-insertions = … de más, %
lab-deletions = … que faltan, %
lab-substitutions = … cambiados, %
lab-wer = Palabras erróneas, %
lab-oov = Palabras fuera del léxico, %
lab-kspc = Pulsaciones por carácter
lab-hits = Pulsaciones acertadas, %
lab-travel = Giro articular, °/carácter
lab-worst = Peor décima parte
lab-worst-values = { $cer } % erróneos; { $wpm } palabras/min
lab-untypable = La distribución no puede escribir estos caracteres, que se omiten: { $characters }
lab-unreached = Fuera del alcance de algunas personas: { $names }
lab-minus = { $second } menos { $first }
lab-points-cer = Caracteres erróneos, puntos
lab-points-uncomfortable = Fuera del rango cómodo, puntos
lab-points-tasks = Tareas hechas, puntos
lab-seconds-task = Segundos por tarea
lab-throughput = Rendimiento, bit/s
lab-points-misses = Clics fuera del objetivo, puntos
lab-worst-people = Peores personas
lab-watch-hint = Haga clic en una persona para ver la frase que peor le salió
lab-watch-tasks = Las tareas no se pueden ver
lab-person = Persona { $number }, { $hand } mm, { $fingers }: { $failure } %
lab-heat-hint = Cuanto más fuerte el color, más pulsaciones fallaron el control; señale uno para ver sus cifras
lab-watch-note = una persona simulada; nada se escribe en otros programas
lab-watch-back = Volver al laboratorio
lab-watch-next = Siguiente fallo
lab-watch-failure = siguiente: { $pressed } en vez de { $meant }
lab-watch-unmeant = ninguna tecla
lab-watch-nothing = nada
lab-watch-presented = Para escribir
lab-watch-typed = Escrito

## Sesión de otro programa

attached-name = Otra sesión: { $session }
attached-process = Proceso { $process }
attached-hint = La ventana muestra la sesión de otro programa y le envía órdenes. Al cerrar la ventana la sesión no termina.
attached-next-profile = Perfil siguiente
attached-text = Decodificador de texto
attached-literal = No cambia nada
attached-suggest = Ofrece candidatos
attached-auto = Corrige palabras
attached-sensors = Los canales, el filtro y la calibración están en el programa de esta sesión. Para una sesión de esta ventana: ademan studio --attach off
